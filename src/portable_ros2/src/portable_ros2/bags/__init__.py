"""Recordings of topics: MCAP files in folders as rosbag2 writes and reads them."""

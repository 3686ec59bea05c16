"""Three nodes that drive a robot by words.

They are status_publisher, command_subscriber and velocity_publisher.
"""

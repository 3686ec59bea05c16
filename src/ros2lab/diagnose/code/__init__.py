"""Rules over Python code, whatever it is for."""

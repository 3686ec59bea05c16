"""Three nodes that drive a robot by words: status_publisher, command_subscriber, velocity_publisher."""

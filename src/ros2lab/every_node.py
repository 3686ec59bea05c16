"""What every node has, and what therefore tells nothing of one."""

TOPICS = frozenset(("/rosout", "/parameter_events"))
# Each node with use_sim_time subscribes to /clock, whether anybody publishes it or not.
OF_MANAGED = "/transition_event"  # the end of a topic that each node with a life cycle has
HIDDEN_TOPICS = TOPICS | {"/clock"}
# What rclpy declares by itself, with every parameter below `qos_overrides`.
PARAMETERS = frozenset(("use_sim_time", "start_type_description_service", "qos_overrides"))

"""What every node has, and what therefore tells nothing of one."""

TOPICS = frozenset(("/rosout", "/parameter_events"))
# Each node with use_sim_time subscribes to /clock, whether anybody publishes it or not.
HIDDEN_TOPICS = TOPICS | {"/clock"}

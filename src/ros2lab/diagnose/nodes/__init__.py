"""Rules over nodes: what they make, publish, keep and declare, and whether their topics meet."""

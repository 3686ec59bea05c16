"""Rules over packages: manifests, setup files, entry points, where things lie and what was installed."""

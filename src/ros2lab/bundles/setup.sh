#!/usr/bin/env bash
# Gradescope runs this once, when it makes the autograder's image.
set -euo pipefail
apt-get update
DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends python3-venv bubblewrap
python3 /autograder/source/ros2lab/tools/bootstrap.py instructor

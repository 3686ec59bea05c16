# The course in a container, by the two commands of README:
#
#     docker build --tag ros2lab .
#     docker run --rm --interactive --tty --network host --volume ros2lab:/home/student/ros2lab/work ros2lab
#
# JupyterLab listens on 127.0.0.1 alone, which is why the container has the machine's network.
# With `--build-arg GROUP=hub` it is also what a JupyterHub starts: deploy/kubernetes.
# `make pythons ONLY=container` does the same steps on a bare Debian, where there is no Docker.
FROM debian:trixie-slim

RUN apt-get update \
    && apt-get install --yes --no-install-recommends python3-venv make git bash ca-certificates bubblewrap \
    && rm --recursive --force /var/lib/apt/lists/* \
    && useradd --uid 1000 --create-home --shell /bin/bash student

USER student
WORKDIR /home/student/ros2lab

# What is installed has a layer of its own, for lessons change more often.
COPY --chown=student pyproject.toml README.md LICENSE ./
COPY --chown=student locks locks
COPY --chown=student tools tools
COPY --chown=student src src
ARG GROUP
RUN python3 tools/bootstrap.py "${GROUP:-student}" && mkdir work
COPY --chown=student . .

VOLUME /home/student/ros2lab/work
CMD ["make", "lab"]

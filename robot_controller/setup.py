"""Build instructions for colcon."""

from setuptools import setup

PACKAGE = "robot_controller"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=[PACKAGE],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/launch", ["launch/robot.launch.py"]),
        (f"share/{PACKAGE}/config", ["config/robot.yaml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},  # colcon test then runs pytest
    zip_safe=True,
    maintainer="ros2lab",
    maintainer_email="ros2lab@example.org",
    description="Three nodes that drive a robot by words: status, commands and velocity.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            f"status_publisher = {PACKAGE}.executables:status_publisher",
            f"command_subscriber = {PACKAGE}.executables:command_subscriber",
            f"velocity_publisher = {PACKAGE}.executables:velocity_publisher",
        ],
    },
)

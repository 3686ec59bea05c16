"""The small programs that launch files start."""

from setuptools import setup

PROGRAMS = ("say", "fail", "dies", "waits", "stubborn", "shows", "terminal")

setup(
    name="parts",
    version="1.2.3",
    packages=["parts"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/parts"]),
        ("share/parts", ["package.xml"]),
        ("share/parts/config", ["config/values.yaml"]),
    ],
    install_requires=["setuptools"],
    maintainer="Anna",
    maintainer_email="anna@example.org",
    description="Small programs for launch files",
    license="Apache-2.0",
    entry_points={"console_scripts": [f"{name} = parts.programs:{name}" for name in PROGRAMS]},
)

from setuptools import setup

package_name = "lamp"

setup(
    name=package_name,
    version="0.0.0",
    packages=[package_name],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + package_name]),
        ("share/" + package_name, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="Ada Lovelace",
    maintainer_email="ada@example.org",
    description="A lamp that is switched by a service",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "lamp = lamp.lamp:main",
        ],
    },
)

"""Launch files in YAML, to be included."""

from __future__ import annotations

from launch.launch_description_sources import FrontendLaunchDescriptionSource
from launch.some_substitutions_type import SomeSubstitutionsType
from launch_yaml import Parser


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A YAML launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(launch_file_path, parser=Parser, method="interpreted YAML launch file")

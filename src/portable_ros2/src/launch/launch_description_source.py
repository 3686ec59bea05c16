"""Where a launch description comes from."""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING

import launch.logging
from launch.launch_context import LaunchContext
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.launch_description import LaunchDescription
    from launch.some_substitutions_type import SomeSubstitutionsType


class LaunchDescriptionSource:
    """A launch description, or a file that holds one.

    Args:
        launch_description: the description, None if it is read when it is needed.
        location: the path.
        method: how it is read, for people.
    """

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutionsType = "<string>",
        method: str = "unspecified mechanism from a script",
    ) -> None:
        self.method = method
        self._launch_description = launch_description
        self._location = normalize_to_list_of_substitutions(location)
        self._expanded_location: str | None = None

    @property
    def location(self) -> str:
        """The path, or a text for people as long as the path is not known."""
        if self._expanded_location is None:
            return " + ".join(str(sub) for sub in self._location)
        return self._expanded_location

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the description; it is read at the first time."""
        if self._expanded_location is None:
            self._expanded_location = perform_substitutions(context, self._location)
        if self._launch_description is None:
            self._launch_description = self._get_launch_description(self._expanded_location)
        return self._launch_description

    def try_get_launch_description_without_context(self) -> LaunchDescription | None:
        """Return the description if it can be read before launching."""
        if self._launch_description is not None:
            return self._launch_description
        try:
            return self._get_launch_description(perform_substitutions(LaunchContext(), self._location))
        except Exception:  # whatever a launch file raises, it is told when it is launched
            launch.logging.get_logger(__name__).debug(traceback.format_exc())
            return None

    def _get_launch_description(self, location: str) -> LaunchDescription:
        raise RuntimeError(f"{type(self).__name__} has no launch description and cannot read '{location}'.")

"""Launch files where no ROS 2 is installed: a small launch with the names and the behaviour of Jazzy's.

Only what courses use is here; the rest names the real package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch import paths
from launch.lookup import lookup

if TYPE_CHECKING:
    from launch.action import Action as Action
    from launch.condition import Condition as Condition
    from launch.event import Event as Event
    from launch.event_handler import EventHandler as EventHandler
    from launch.invalid_launch_file_error import InvalidLaunchFileError as InvalidLaunchFileError
    from launch.launch_context import LaunchContext as LaunchContext
    from launch.launch_description import LaunchDescription as LaunchDescription
    from launch.launch_description_entity import LaunchDescriptionEntity as LaunchDescriptionEntity
    from launch.launch_description_source import LaunchDescriptionSource as LaunchDescriptionSource
    from launch.launch_introspector import LaunchIntrospector as LaunchIntrospector
    from launch.launch_service import LaunchService as LaunchService
    from launch.some_entities_type import SomeEntitiesType as SomeEntitiesType
    from launch.some_substitutions_type import SomeSubstitutionsType as SomeSubstitutionsType
    from launch.substitution import Substitution as Substitution

_DEFINED_IN = {
    "Action": "action",
    "Condition": "condition",
    "Event": "event",
    "EventHandler": "event_handler",
    "InvalidLaunchFileError": "invalid_launch_file_error",
    "LaunchContext": "launch_context",
    "LaunchDescription": "launch_description",
    "LaunchDescriptionEntity": "launch_description_entity",
    "LaunchDescriptionSource": "launch_description_source",
    "LaunchIntrospector": "launch_introspector",
    "LaunchService": "launch_service",
    "SomeEntitiesType": "some_entities_type",
    "SomeEntitiesType_types_tuple": "some_entities_type",
    "SomeSubstitutionsType": "some_substitutions_type",
    "SomeSubstitutionsType_types_tuple": "some_substitutions_type",
    "Substitution": "substitution",
}
paths.install()
__getattr__ = lookup(__name__, defined_in=_DEFINED_IN)

__all__ = [  # noqa: PLE0604 -- names that are imported when they are asked for
    *_DEFINED_IN,
    "actions",
    "conditions",
    "descriptions",
    "event_handlers",
    "events",
    "frontend",
    "launch_description_sources",
    "logging",
    "substitutions",
    "utilities",
]

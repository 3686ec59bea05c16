"""Interfaces by their names, such as `std_msgs/msg/String`."""

from __future__ import annotations

from typing import Any

from portable_ros2.messages import TypeNotFoundError, find_action, find_message, find_service

_FIND = {"msg": find_message, "srv": find_service, "action": find_action}


def get_interface(identifier: str) -> Any:
    """Return the class of a message, service or action; ValueError if the name has no kind, or there is none."""
    kind = identifier.split("/")[1:2]
    return _found(identifier, kind[0] if kind and kind[0] in _FIND else "msg")


def get_message(identifier: str) -> Any:
    """Return the class of a message; ValueError if there is none."""
    return _found(identifier, "msg")


def get_service(identifier: str) -> Any:
    """Return the class of a service; ValueError if there is none."""
    return _found(identifier, "srv")


def get_action(identifier: str) -> Any:
    """Return the class of an action; ValueError if there is none."""
    return _found(identifier, "action")


def _found(identifier: str, kind: str) -> Any:
    try:
        return _FIND[kind](identifier)
    except TypeNotFoundError as error:
        raise ValueError(str(error)) from error

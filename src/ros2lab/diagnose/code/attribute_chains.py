"""Attributes of self that are asked for another one, where a single method or the other way round was meant."""

from __future__ import annotations

import ast
from collections.abc import Collection

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass


def chain_fault(owner: NodeClass, node: ast.Attribute, members: Collection[str]) -> Finding | None:
    """Return the finding of `self.get.logger()` for `get_logger`, or of `self.cancel.timer()` for `timer.cancel`."""
    asked = owner.source.above(node)
    if not isinstance(asked, ast.Attribute):
        return None
    is_called = owner.source.is_called(asked)
    made = {text for text, _ in owner.source.made}
    written, joined = ast.unparse(asked), f"{node.attr}_{asked.attr}"
    if joined in members:
        cause = f"{written} asks self for {node.attr} first, which it does not have: the name has no dot."
        meant = f"self.{joined}"
    elif is_called and f"self.{asked.attr}" in made and asked.attr in owner.attributes:
        cause = f"{written} asks self for {node.attr}, which it does not have: {asked.attr} comes first."
        meant = f"self.{asked.attr}.{node.attr}"
    else:
        return None
    return Finding("attribute-missing", cause, owner.source.at(node), f"write {meant} instead of {written}")

"""Names that an attribute or a method of a class may be given."""

from __future__ import annotations

from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.python_source import walk


def free_name(owner: NodeClass, wished: str) -> str:
    """Return a name that neither a node nor the class has: the one that is wished, or it with underscores after it."""
    taken = node_members() | owner.attributes
    taken |= {node.attr for node in walk(owner.definition) if is_self_attribute(node)}
    while wished in taken:
        wished += "_"
    return wished

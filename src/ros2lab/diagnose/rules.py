"""The rules over Python files, in the order in which they tell what they find."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

from ros2lab.diagnose.code.argument_names import argument_name_faults
from ros2lab.diagnose.code.at_hand import IF_TEXT, with_quotes
from ros2lab.diagnose.code.changed_loops import changed_loops
from ros2lab.diagnose.code.defined_once import defined_once
from ros2lab.diagnose.code.expression_faults import expression_faults
from ros2lab.diagnose.code.flow_faults import flow_faults
from ros2lab.diagnose.code.hidden_names import bound_twice, hidden_names
from ros2lab.diagnose.code.imports import import_faults
from ros2lab.diagnose.code.line_ends import line_end_faults
from ros2lab.diagnose.code.locks import lock_faults
from ros2lab.diagnose.code.lost_parameters import lost_parameters
from ros2lab.diagnose.code.one_time import one_time_faults
from ros2lab.diagnose.code.private_names import private_name_faults
from ros2lab.diagnose.code.syntax_repairs import syntax_finding
from ros2lab.diagnose.code.units import unit_faults
from ros2lab.diagnose.finding import Finding, ranked, stops_node
from ros2lab.diagnose.net import changed, guarded
from ros2lab.diagnose.nodes.bursts import burst_faults
from ros2lab.diagnose.nodes.life_faults import life_faults
from ros2lab.diagnose.nodes.message_faults import message_faults
from ros2lab.diagnose.nodes.node_faults import node_faults
from ros2lab.diagnose.nodes.read_parameters import parameter_faults
from ros2lab.diagnose.nodes.topic_faults import ends_of, topic_faults
from ros2lab.diagnose.nodes.use_faults import use_faults
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource


def source_faults(sources: NodeSources, mains: list[str] | None = None) -> Iterator[Finding]:
    """Yield what is wrong with the nodes of some Python files.

    Args:
        sources: the files.
        mains: the functions that executables call, such as `pk.talk.main`; None takes every `main`.
    """
    twice = [*guarded(bound_twice, sources)]
    # Where a name means something else than it should, what else is said of the line is said of the wrong thing.
    places = {finding.place for finding in twice}
    found = [finding for finding in _source_faults(sources, mains) if finding.place not in places]
    yield from (changed(_fitting, finding, sources, found) for finding in found)
    yield from twice


def _fitting(finding: Finding, sources: NodeSources, known: Collection[Finding]) -> Finding:
    """Return a finding without the fix that puts quotes around a name where the rules object to the text."""
    _, _, otherwise = finding.fix.partition(IF_TEXT)
    file, _, line = finding.place.rpartition(":")
    source = next((one for one in sources.sources.values() if otherwise and one.shown == file), None)
    if source is None:
        return finding
    quoted = with_quotes(source, int(line), otherwise)
    new = guarded(message_faults, NodeSources({**sources.sources, source.name: quoted}))
    codes = {one.code for one in known if one.place == finding.place}
    is_wrong = any(one.place == finding.place and one.code not in codes and stops_node(one) for one in new)
    return replace(finding, fix=otherwise) if is_wrong else finding


def _source_faults(sources: NodeSources, mains: list[str] | None) -> Iterator[Finding]:
    for source in sources.sources.values():
        yield from guarded(_syntax_faults, source)
        yield from guarded(import_faults, sources, source)
    for rule in (lost_parameters, node_faults, message_faults, expression_faults):
        yield from guarded(rule, sources)
    yield from guarded(life_faults, sources, mains)
    for rule in (
        changed_loops,
        private_name_faults,
        hidden_names,
        one_time_faults,
        defined_once,
        line_end_faults,
        burst_faults,
        *(flow_faults, unit_faults, lock_faults, use_faults, argument_name_faults),
        parameter_faults,
    ):
        yield from guarded(rule, sources)


def _syntax_faults(source: PythonSource) -> Iterator[Finding]:
    if source.fault:
        yield syntax_finding("node-syntax", source)


def text_faults(source: PythonSource) -> list[Finding]:
    """Return what is wrong with a single Python file or notebook cell."""
    sources = NodeSources({source.name: source})
    of_topics = guarded(lambda: topic_faults(ends_of(sources)))
    return ranked([*source_faults(sources, []), *of_topics])

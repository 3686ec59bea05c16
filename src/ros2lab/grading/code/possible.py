"""What names in code may hold when it runs, and so which conditions can come true.

A branch that waits for an attribute that is only ever False is never reached. Values from outside, such as a
message's field or the result of a library, may be anything of their type; those not followed, anything at all.
"""

from __future__ import annotations

import ast
import builtins
import itertools
import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import YIELDS, Function, PythonSource, own_nodes, parameters, walk
from ros2lab.diagnose.sources.static_value import UNKNOWN
from ros2lab.grading.code.arguments import Arguments
from ros2lab.grading.code.assigned import Store, Stores, value_before
from ros2lab.grading.code.cases import (
    COMPUTED,
    FAILS,
    Case,
    Given,
    Member,
    changed,
    is_leaf,
    is_truth,
    leaves,
    parted,
    plain,
    range_within,
    samples,
    text_of,
    value_of,
)
from ros2lab.grading.code.comparisons import Comparisons
from ros2lab.grading.code.declared import declarations, parameter_in
from ros2lab.grading.code.own_messages import Messages
from ros2lab.grading.code.ranges import Numbers, Range, computed, is_no_loss, is_pure, joined, of_value

MOST_VALUES = 20  # values that a name is followed through
MOST_CASES = 2000  # combinations of values that one condition is tried with
DEEPEST = 8  # calls and names that are followed one after the other

Values = frozenset[Any]
ANY: Values = frozenset((Given(),))
Fact = tuple[ast.expr, bool]  # a condition, and whether it holds
Facts = tuple[Fact, ...]


class _TooManyError(Exception):
    pass


class Possible:
    """What names may hold in those parts of some files that are known to run.

    Args:
        sources: the files.
        code: the code that runs; only assignments in it count.
        messages: what is known of messages.
        as_declared: whether parameters have their declared values; else they may be anything.
    """

    def __init__(
        self,
        sources: NodeSources,
        code: Collection[ast.AST],
        messages: Messages,
        *,
        as_declared: bool = False,
    ) -> None:
        self.messages = messages
        self.arguments = Arguments(sources, code)
        self._as_declared = as_declared
        self._sources = sources
        self._code = code
        self._depth = 0
        self._known: dict[object, Values] = {}

    def outcomes(self, test: ast.expr, facts: Facts = ()) -> frozenset[bool]:
        """Return the truth values that a condition may have where some facts hold."""
        if test not in self.scopes:
            return frozenset((True, False))
        return frozenset(truth for truth in (True, False) if self._can_hold((*facts, (test, truth))))

    def values(self, expression: ast.expr | None) -> Values:
        """Return the values that an expression may have; `ANY`, or with a `Given`, if not all are known."""
        if expression is None or expression not in self.scopes or self._depth > DEEPEST:
            return ANY
        self._depth += 1
        try:
            if is_leaf(expression):
                return frozenset(
                    alternative for value in self._of_leaf(expression) for alternative in parted(value)
                )
            found = set[Any]()
            for case in self._cases([expression], has_samples=False):
                value = value_of(expression, case)
                found |= {self.told(expression)} if value in (UNKNOWN, FAILS) else {plain(value)}
                if len(found) > MOST_VALUES:
                    return ANY
            if Given() in found and is_truth(expression):
                return frozenset(self.outcomes(expression))
            return frozenset(found)
        except (TypeError, RecursionError):  # unhashable, or too deep
            return ANY
        finally:
            self._depth -= 1

    # --- conditions ---

    def _can_hold(self, facts: Facts) -> bool:
        try:
            cases = self._cases([test for test, _ in facts], has_samples=True)
            return any(all(self._fits(test, truth, case) for test, truth in facts) for case in cases)
        except (_TooManyError, RecursionError):
            return True if len(facts) == 1 else self._can_hold(facts[-1:])

    def _fits(self, test: ast.expr, truth: bool, case: Case) -> bool:
        value = value_of(test, case)
        try:
            return value is not FAILS and (
                value is UNKNOWN or isinstance(value, Given) or bool(value) is truth
            )
        except Exception:
            return True

    def _cases(self, expressions: Sequence[ast.expr], *, has_samples: bool) -> Iterator[Case]:
        """Yield the combinations of values that the names and attributes in some expressions may have."""
        held: dict[str, ast.expr] = {}
        for expression in expressions:
            held |= {text_of(leaf): leaf for leaf in leaves(expression)}
        told = Comparisons(expressions if has_samples else (), self.values, self._is_computed)
        compared, wholes = told.constants, told.computed
        held |= wholes
        choices = [
            [
                sample
                for value in ([self.told(leaf)] if name in wholes else self._of_leaf(leaf))
                for sample in samples(value, compared.get(name))
            ]
            for name, leaf in held.items()
        ]
        if math.prod(map(len, choices)) > MOST_CASES:
            if has_samples:
                raise _TooManyError
            choices = [[UNKNOWN] for _ in choices]
        for combination in itertools.product(*choices):
            yield dict(zip(held, combination, strict=True))

    def _is_computed(self, operand: ast.expr) -> bool:
        """Return whether an operand is computed from what is not known, and its range is known all the same."""
        if not isinstance(operand, COMPUTED) or operand not in self.scopes:
            return False
        source = self.scopes[operand][0]
        given = [value for leaf in leaves(operand) for value in self._of_leaf(leaf)]
        return (
            any(isinstance(value, Given) for value in given)
            and is_pure(operand, lambda function: self._function(source, function))
            and self.range_of(operand) is not None
        )

    def range_of(self, expression: ast.expr | None) -> Range | None:
        """Return the numbers or texts that an expression may come to; None if it may be anything else."""
        if isinstance(expression, ast.Constant):
            return of_value(expression.value)
        if expression is None or expression not in self.scopes:
            return None
        name = ""
        if isinstance(expression, ast.Call):
            name = self._function(self.scopes[expression][0], expression.func)
            if known := computed(expression, name, self.range_of):
                return known
        if is_leaf(expression):
            return joined(map(range_within, self._of_leaf(expression)))
        return computed(expression, name, self.range_of)

    def _function(self, source: PythonSource, function: ast.expr) -> str:
        """Return the whole name of a function, also of one that Python has by itself; empty if it is not known."""
        name = self._sources.resolve(source, function)
        if name is None and isinstance(function, ast.Name) and (source, function.id) not in self._stores:
            name = function.id if hasattr(builtins, function.id) else None
        return name or ""

    def told(self, expression: ast.expr) -> Given:
        """Return what is known of an expression whose value is not."""
        within = self.range_of(expression)
        return Given(within.kind, within) if within else Given()

    # --- names ------------------------------------------------------------------------------------------

    def _of_leaf(self, leaf: ast.expr) -> Values:
        """Return the values that a name, an attribute or a call may have."""
        scope = self.scopes.get(leaf)
        if scope is None:
            return ANY
        source, owner, function = scope
        match leaf:
            case ast.Name(id=name):
                before = value_before(source, leaf, name) if function else None
                return self.values(before) if before else self._of_name(source, function, name)
            case ast.Attribute(attr=name) if is_self_attribute(leaf) and owner:
                return self._of_attribute(owner, name)
            case ast.Attribute():
                return self._of_member(source, leaf)
            case ast.Call():
                return self._of_call(source, owner, leaf)
        return ANY

    def _of_name(self, source: PythonSource, function: Function | None, name: str) -> Values:
        inner: ast.AST | None = function
        while isinstance(inner, (ast.FunctionDef, ast.AsyncFunctionDef)):
            if name in {argument.arg for argument in walk(inner.args) if isinstance(argument, ast.arg)}:
                given = self._of_parameter(inner, name)
                return given | self._stored((inner, name)) if (inner, name) in self._stores else given
            if (inner, name) in self._stores:
                return self._stored((inner, name))
            inner = self.scopes[inner][2] if inner in self.scopes else None
        if name in source.names and (source, name) not in self._stores:
            return ANY
        return self._stored((source, name))

    def _of_parameter(self, function: Function, name: str) -> Values:
        """Return what a parameter may be: a callback's message, or what the calls give it; else `ANY`."""
        kinds = self._callbacks.get(function, set())
        names = [parameter.arg for parameter in parameters(function) if parameter.arg != "self"]
        if kinds:
            return frozenset(map(Given, kinds)) if names[:1] == [name] else ANY
        key = ("argument", function, name)
        if key not in self._known:
            self._known[key] = ANY  # if it is handed on to itself
            given = None if self.is_open else self.arguments.of(function, name)
            found = ANY if given is None else frozenset[Any]().union(*map(self.values, given))
            self._known[key] = found if len(found) <= MOST_VALUES else ANY
        return self._known[key]

    @cached_property
    def _callbacks(self) -> Mapping[Function, set[str]]:
        found: dict[Function, set[str]] = defaultdict(set)
        for creation, function in self._sources.callbacks():
            given = creation.given("msg_type")
            kind = self._sources.resolve(creation.source, given) or ""
            found[function].add(kind if creation.method == "create_subscription" else "")
        return found

    def _of_attribute(self, owner: NodeClass, name: str) -> Values:
        """Return what an attribute of self may be: whatever code assigns to it, or to one of this name of any object."""
        chain, _, is_known = self._sources.lineage(owner)
        is_made = any(name in found.methods or found.definition.decorator_list for found in chain)
        if not is_known or self.is_open or is_made:
            return ANY
        stores = self._stores.get(name)
        others = {store for store in stores or () if self._is_of_another(store, chain)}
        own = [store for store in stores or () if store not in others]
        return self._stored((owner, name), own) if others else self._stored(name)

    def _is_of_another(self, store: Store, chain: Sequence[NodeClass]) -> bool:
        """Return whether an assignment is to self in a class that has nothing to do with some classes."""
        owner = self.scopes[store.target][1]
        if owner is None or not is_self_attribute(store.target):
            return False
        others, _, is_known = self._sources.lineage(owner)
        return is_known and not {*others} & {*chain}

    def _of_member(self, source: PythonSource, leaf: ast.Attribute) -> Values:
        """Return what an attribute of any other object may be, such as a class member or a message field."""
        whole = self._sources.resolve(source, leaf) or ""
        if whole in ("math.nan", "math.inf", "numpy.nan", "numpy.inf"):
            return frozenset((math.nan if whole.endswith("nan") else math.inf,))
        owner = self._sources.classes.get(whole.rpartition(".")[0])
        if owner and any(base and base.startswith("enum.") for base in owner.bases):
            return frozenset((Member(whole),))
        if owner and owner.attributes and not self.is_open:
            return self._stored(leaf.attr)
        if self._as_declared and (name := parameter_in(leaf.value)):
            return self._of_declared(source, name)
        found = set[Any]()
        for value in self.values(leaf.value):
            if not isinstance(value, (Given, Member)) and not hasattr(value, leaf.attr):
                continue  # an AttributeError: nothing follows
            fields = (
                self.messages.fields_of(value.kind)
                if isinstance(value, Given) and is_interface(value.kind)
                else None
            )
            kind = (fields or {}).get(leaf.attr, "")
            found.add(Given(kind.replace("/", ".msg.") if "/" in kind else kind))
        return frozenset(found)

    def _of_declared(self, source: PythonSource, name: str) -> Values:
        """Return the declared values of a parameter: in the file that gets it, else in all files."""
        given = self._declarations.get(name, ())
        own = [value for value in given if self.scopes[value][0] is source]
        return frozenset(held for value in own or given for held in self.values(value)) or ANY

    @cached_property
    def _declarations(self) -> Mapping[str, list[ast.expr]]:
        return declarations(self._code)

    def _of_call(self, source: PythonSource, owner: NodeClass | None, call: ast.Call) -> Values:
        name = self._function(source, call.func)
        if is_interface(name):
            return frozenset((Given(name),))
        if name == "str":
            return frozenset((Given("string"),))
        called = self._sources.method(owner, call.func.attr) if is_self_attribute(call.func) else None
        if called is None and name in self._sources.functions:
            called = self._sources.functions[name][1]
        if called:
            return self._returned(called)
        within = computed(call, name, self.range_of)
        return frozenset((Given(within.kind, within),)) if within else ANY

    def _returned(self, function: Function) -> Values:
        """Return the values that a function of the files may return."""
        inside = own_nodes(function)
        is_plain = isinstance(function, ast.FunctionDef) and not function.decorator_list
        if not is_plain or any(isinstance(node, YIELDS) for node in inside):
            return ANY
        if function in self._known:
            return self._known[function]
        self._known[function] = ANY  # if it calls itself
        found = (
            frozenset[Any]() if isinstance(function.body[-1], (ast.Return, ast.Raise)) else frozenset((None,))
        )
        for node in inside:
            if isinstance(node, ast.Return) and node in self._code:
                found |= self.values(node.value) if node.value else frozenset((None,))
        self._known[function] = found
        return found

    # --- what is assigned -------------------------------------------------------------------------------

    def _stored(self, key: object, stores: Sequence[Store] | None = None) -> Values:
        """Return the values assigned to a name or an attribute; empty if no code that runs assigns to it."""
        if key in self._known:
            return self._known[key]
        stores = stores or self._stores.get(key)
        if not stores:
            return ANY  # it comes from elsewhere
        self._known[key] = ANY  # if it is computed from itself
        found = frozenset[Any]()
        live = [store for store in stores if store.node in self._code]
        for store in live:
            if not store.is_change:
                found |= self._of_store(store)
        known = {**self._known, key: found}
        self._known = {**known}
        for store in live:
            if store.is_change and not self._of_change(store, found) <= found:
                found = self._widened(key, found, live)
                break
        # What was found out meanwhile rests on values that were only tried.
        self._known = known | {key: found if len(found) <= MOST_VALUES else ANY}
        return self._known[key]

    def _widened(self, key: object, first: Values, stores: Iterable[Store]) -> Values:
        """Return what a number may be that changes again and again, by what it is at first; `ANY` for anything else."""
        grows = all(
            not store.is_change
            or (isinstance(store.change, ast.Add) and is_no_loss(self.range_of(store.value)))
            for store in stores
        )
        begins = joined(map(range_within, first))
        if not isinstance(begins, Numbers):
            return ANY
        for is_whole in (True, False) if begins.is_whole else (False,):
            wider = Numbers(begins.low if grows else -math.inf, math.inf, is_whole)
            self._known[key] = frozenset((Given(wider.kind, wider),))
            found = [
                joined(map(range_within, self._changed(store, key))) for store in stores if store.is_change
            ]
            if all(isinstance(known, Numbers) and known.is_whole >= is_whole for known in found):
                return self._known[key]
        self._known[key] = ANY
        return ANY

    def _changed(self, store: Store, key: object) -> Values:
        """Return the values after an assignment, of which only the range counts."""
        if store.change is None:
            return self._of_store(store)
        both = [range_within(value) for value in (*self._known[key], *self._of_store(store))]
        whole = all(isinstance(known, Numbers) and known.is_whole for known in both)
        is_plain = isinstance(store.change, (ast.Add, ast.Sub, ast.Mult))
        wider = Numbers(is_whole=whole and is_plain)
        return frozenset((Given(wider.kind, wider),)) if joined(both) else ANY

    def _of_change(self, store: Store, before: Values) -> Values:
        """Return the values after an assignment, by those before it."""
        values = self._of_store(store)
        sign = store.change
        return frozenset(changed(old, sign, by) for old in before for by in values) if sign else values

    def _of_store(self, store: Store) -> Values:
        values = self.values(store.value)
        for index in store.path:
            parts = [
                value[index] if isinstance(value, tuple) and len(value) > index else Given()
                for value in values
            ]
            values = frozenset(parts)
        return values

    @cached_property
    def _stores(self) -> Stores:
        return Stores(self.scopes)

    def stores_of(self, leaf: ast.Name | ast.Attribute) -> list[Store]:
        """Return all assignments to a variable of a function, a global name or an attribute."""
        return (
            self._stores.get(self._stores.key(leaf))
            or self._stores.get((self.scopes[leaf][0], text_of(leaf)))
            or []
        )

    def stored_in(self, target: ast.expr) -> Values:
        """Return the values that the target of an assignment may hold before it."""
        return (
            self._stored(self._stores.key(target)) if isinstance(target, (ast.Name, ast.Attribute)) else ANY
        )

    @cached_property
    def scopes(self) -> Mapping[ast.AST, tuple[PythonSource, NodeClass | None, Function | None]]:
        """By node, the file, the class and the function that it stands in."""
        return {
            node: (source, owner, function)
            for source in self._sources.sources.values()
            for owner, function, node in self._sources.scoped(source)
        }

    @cached_property
    def is_open(self) -> bool:
        """Whether code may set attributes by computed names, or hand a node on to other code."""
        return any(
            self._sources.hands_itself_on(source)
            or any(word in source.text for word in ("setattr", "__dict__", "vars(", "exec("))
            for source in self._sources.sources.values()
        )

"""ROS's own environment variables with values that ROS refuses, or that ask for what is not installed."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.transcript import Step
from ros2lab.diagnose.sources.spelling import nearest

_NAME = r"(?P<name>(?:ROS|RMW|RCL|RCUTILS)_[A-Z_]+)"
_MIDDLEWARE, _DOMAIN = "RMW_IMPLEMENTATION", "ROS_DOMAIN_ID"
# How rcl, rcutils and the middleware refuse a value: most name the variable, some only what it is for.
_REFUSALS = (
    (rf"(?:[Uu]nexpected|[Ii]nvalid) value \W(?P<value>[^\]']*)\W.*?\b{_NAME}\b(?:.*?Valid values are (?P<allowed>.+?)\.?,)?", ""),
    (rf"\b{_NAME}\W+(?:is not|(?:is )?(?:out of range|invalid))", ""),
    (r"RMW implementation identifier of '(?P<value>\w+)' but instead found '(?P<there>\w+)'", _MIDDLEWARE),
    (r"\blib(?P<value>rmw_\w+?)\.so\b.*(?:cannot open|dlopen|failed to load)|(?:failed to load|could not load).*\blib(?P<other>rmw_\w+?)\.so", _MIDDLEWARE),
    (r"Probably the domainId is over", _DOMAIN),
)  # fmt: skip
_ALLOWED = {_DOMAIN: "it must be a whole number from 0 to 101"}
_WARNING = "[WARN]"
_SET = r"(?:^|[;&] *)(?:export +)?{name}=(?P<value>\"[^\"]*\"|'[^']*'|[^\s;&]*)"


def of_ros_variable(error: ErrorText) -> Finding | None:
    """Return the finding about a variable whose value ROS refuses; None if the text refuses none."""
    refused = _refused(error)
    if refused is None:
        return None
    name, there = refused["name"], refused.get("there", "")
    typed = re.compile(_SET.format(name=name))
    found = ((line, match) for line in reversed(error.typed) if (match := typed.search(line)))
    line, match = next(found, ("", None))
    value = refused["value"] or (match["value"].strip("\"'") if match else "")
    near = nearest(value, [there], 0.85) if value and there else None
    cause = f"The variable {name} is set to {value or 'a value'}{'' if value else ' that ROS refuses'}"
    if name == _MIDDLEWARE:
        what = f"; {there} is" if there else ""
        cause = f"The variable {name} asks for the middleware {value}, which is not installed here{what}.{f' Did you mean {near}?' if near else ''}"
    else:
        valid = refused.get("allowed", "")
        allowed = _ALLOWED.get(name) or (f"valid values are {valid}" if valid else "")
        cause += f"{', which ROS refuses' if value else ''}{f': {allowed}' if allowed else ''}."
    return Finding("typed-wrong", cause, "", _fix(name, line, match, near))


def _refused(error: ErrorText) -> dict[str, str] | None:
    """Return what is said of a value that was refused when the last command ran; None if none was, or with a warning."""
    for line in _last_output(error.steps):
        if error.reports and _WARNING in line:
            continue
        for pattern, about in _REFUSALS:
            if match := re.search(pattern, line):
                said = {key: text or "" for key, text in match.groupdict().items()}
                value = said.get("value") or said.get("other") or ""
                return {**said, "name": about or said["name"], "value": value}
    return None


def _last_output(steps: Sequence[Step]) -> list[str]:
    """Return what the last command printed; rcutils sets off its own lines by what looks like a prompt."""
    lines: list[str] = []
    for step in reversed(steps):
        lines[:0] = step.lines
        if not step.command.startswith("["):
            break
    return lines


def _fix(name: str, line: str, match: re.Match[str] | None, near: str | None) -> str:
    """Return what to type so that a variable has a valid value, or none: then ROS takes its own default."""
    if match is None:
        return f"type `unset {name}` in this terminal, and remove the line that sets it from ~/.bashrc"
    if near:
        return f"type `{line[: match.start('value')]}{near}{line[match.end() :]}`"
    rest = line[match.end() :].strip()
    is_kept = "export" in match[0] or not rest or rest.startswith((";", "&"))
    return f"type `unset {name}`" if is_kept else f"type `{rest}`"

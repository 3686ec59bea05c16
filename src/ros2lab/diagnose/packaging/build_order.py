"""The order in which colcon builds packages: what each needs, and which dependency more would leave none."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.package import SourcePackage

_LACKING = ("dependency-undeclared", "dependency-launched")


def needed(package: SourcePackage) -> list[Any]:
    """Return the dependencies of a package after which colcon builds it."""
    manifest = package.manifest
    kinds = ("buildtool_depends", "build_depends", "build_export_depends", "exec_depends", "test_depends")
    return [dependency for kind in kinds for dependency in getattr(manifest, kind, ())]


class BuildOrder:
    """What the packages of a workspace need, by their names."""

    def __init__(self, packages: Collection[SourcePackage]) -> None:
        self.needs = {p.name: {dependency.name for dependency in needed(p)} for p in packages}

    def reaches(self, name: str, wanted: str) -> bool:
        """Return whether a package needs another one, itself or through others."""
        seen, ahead = set[str](), [name]
        while ahead:
            current = ahead.pop()
            if current == wanted:
                return True
            if current not in seen:
                seen.add(current)
                ahead += self.needs.get(current, ())
        return False

    def proposed(self, package: SourcePackage, findings: Iterable[Finding]) -> Iterator[Finding]:
        """Yield what is told of a package, without dependencies that close a ring; the others hold from then on."""
        for finding in findings:
            if finding.code in _LACKING:
                if any(self.reaches(name, package.name) for name in finding.about):
                    continue
                self.needs.setdefault(package.name, set()).update(finding.about)
            yield finding

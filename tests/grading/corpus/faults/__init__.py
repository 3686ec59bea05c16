"""Single faults: each is the model with one change, and costs one component, or an item of the bonus."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.bonus import BONUS_FAULTS
from corpus.faults.command import COMMAND_FAULTS
from corpus.faults.documentation import DOCUMENTATION
from corpus.faults.elsewhere import ELSEWHERE_FAULTS
from corpus.faults.manifest import MANIFEST
from corpus.faults.setup_script import ENTRY_POINTS, SETUP_SCRIPT
from corpus.faults.status import STATUS_FAULTS
from corpus.faults.velocity import VELOCITY_FAULTS
from corpus.faults.workspace import WORKSPACE

FAULTS: tuple[Case, ...] = (
    *WORKSPACE,
    *MANIFEST,
    *SETUP_SCRIPT,
    *ENTRY_POINTS,
    *STATUS_FAULTS,
    *COMMAND_FAULTS,
    *VELOCITY_FAULTS,
    *ELSEWHERE_FAULTS,
    *DOCUMENTATION,
    *BONUS_FAULTS,
)

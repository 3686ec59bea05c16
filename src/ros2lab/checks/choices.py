"""Questions that are answered with a click: a lesson's quiz, and its predictions.

A widget knows the answers, and the browser does not: it sends what was chosen, and shows what comes back. What was
chosen is kept with the student's progress, and shown again when the cell is run again. Neither a thread nor ROS
comes after it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import anywidget
import traitlets
import yaml

from ros2lab import progress
from ros2lab.checks.card import NO_FORMULA, inline
from ros2lab.widget_state import WIDGET_VIEW, ending_with_its_kernel

_HERE = Path(__file__).parent
_open: dict[str, Choices] = {}


class Question(NamedTuple):
    """A question with answers to choose from.

    Args:
        text: what is asked; what stands between backticks is code.
        options: the answers, which have the letters a, b, c, ….
        right: the letter of the right answer.
        why: why it is right, in a sentence.
        wrong: what is said to somebody who chose another letter; a nudge, never the right letter.
    """

    text: str
    options: Sequence[str]
    right: str
    why: str
    wrong: Mapping[str, str]

    @property
    def letters(self) -> list[str]:
        """The letters of the options."""
        return _letters(self)


class Prediction(NamedTuple):
    """What a student expects before a cell shows it.

    Args:
        text: what is asked; what stands between backticks is code.
        options: what may be expected; they have the letters a, b, c, ….
        right: the letter of what happens; None where that depends on the student's own work.
        explanation: what happens, and why; told once the prediction is made.
    """

    text: str
    options: Sequence[str]
    right: str | None
    explanation: str


class Choices(anywidget.AnyWidget):
    """Questions, one after the other; subclasses judge the answers.

    Args:
        key: under which the choices are kept with the progress; a widget that is open under it is closed.
        questions: what is asked, with the options.
    """

    _esm = ending_with_its_kernel(_HERE / "choices.js")
    _css = _HERE / "choices.css"
    _KIND = ""

    kind = traitlets.Unicode(read_only=True).tag(sync=True)
    # Of each question its text and its options, as HTML.
    questions: traitlets.List[dict[str, Any]] = traitlets.List(read_only=True).tag(sync=True)
    # Of each question the letters tried, in their order, whether it is done and right, and what is said, as HTML.
    states: traitlets.List[dict[str, Any]] = traitlets.List().tag(sync=True)

    _asked: Sequence[Any]

    def __init__(self, key: str, questions: Sequence[Question | Prediction]) -> None:
        self.key = key
        self._asked = questions
        kept = progress.choices().get(key)
        if isinstance(kept, dict):
            kept = [kept.get("chosen")]
        rows = kept if isinstance(kept, list) and len(kept) == len(questions) else [""] * len(questions)
        self._tried = [_tried(question, str(row)) for question, row in zip(questions, rows, strict=True)]
        super().__init__(states=self._states())
        self.set_trait("kind", self._KIND)
        self.set_trait(
            "questions",
            [
                {"text": inline(question.text), "options": [inline(option) for option in question.options]}
                for question in questions
            ],
        )
        self.on_msg(self._on_message)
        predecessor = _open.get(key)
        if predecessor is not None:
            predecessor.close()
        _open[key] = self

    def choose(self, number: int, letter: str) -> None:
        """Answer a question; what has been answered stays.

        Args:
            number: of the question, from 0.
            letter: of an option.
        """
        if not 0 <= number < len(self._asked) or self._is_done(number):
            return
        if letter not in _letters(self._asked[number]) or letter in self._tried[number]:
            return
        self._tried[number] += letter
        self._keep()  # first, so that what is seen has been kept
        self.states = self._states()

    def close(self) -> None:
        """End the widget. Closing twice does no harm."""
        if _open.get(self.key) is self:
            del _open[self.key]
        super().close()

    def _on_message(self, _: object, content: Any, __: object) -> None:
        if isinstance(content, dict) and isinstance(content.get("question"), int):
            self.choose(content["question"], str(content.get("letter")))

    def _states(self) -> list[dict[str, Any]]:
        return [
            {
                "tried": self._tried[number],
                "is_done": self._is_done(number),
                "is_right": self._is_right(number),
                "said": self._said(number),
            }
            for number in range(len(self._asked))
        ]

    def _is_right(self, number: int) -> bool | None:
        """Return whether the last choice is right; None where there is none, or nothing is right or wrong."""
        tried, right = self._tried[number], self._asked[number].right
        return tried[-1] == right if tried and right else None

    def _is_done(self, number: int) -> bool:
        raise NotImplementedError

    def _said(self, number: int) -> str:
        """Return what is said about the last choice, as HTML; nothing before it."""
        raise NotImplementedError

    def _keep(self) -> None:
        """Keep the choices with the student's progress."""
        progress.keep_choices(self.key, self._tried)

    def _static(self) -> str:
        """Return what a reader without the widget sees, as HTML."""
        raise NotImplementedError

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:  # type: ignore[override]
        view = {"version_major": 2, "version_minor": 0, "model_id": self.model_id}
        return {"text/plain": repr(self), "text/html": self._static(), WIDGET_VIEW: view}


class Quiz(Choices):
    """The quiz at the end of a lesson: a wrong choice gets a nudge, and may be made anew.

    Args:
        key: the exercise that is done when all questions are answered, such as `welcome.quiz`.
        questions: in their order.
    """

    _KIND = "quiz"
    _asked: Sequence[Question]

    @property
    def is_done(self) -> bool:
        """Whether all questions are answered."""
        return all(map(self._is_done, range(len(self._asked))))

    def _is_done(self, number: int) -> bool:
        return self._is_right(number) is True

    def _said(self, number: int) -> str:
        tried = self._tried[number]
        if not tried:
            return ""
        question = self._asked[number]
        return inline(_sentence(question.why if self._is_done(number) else question.wrong[tried[-1]]))

    def _keep(self) -> None:
        super()._keep()
        if self.is_done:
            progress.keep(self.key)

    def _static(self) -> str:
        rows = "".join(f"<li>{inline(question.text)}{_listed(question)}</li>" for question in self._asked)
        return f'<div class="{NO_FORMULA}"><ol>{rows}</ol></div>'

    def __repr__(self) -> str:
        if self.is_done:
            return praise_of(self._asked)
        done = sum(map(self._is_done, range(len(self._asked))))
        rows = [
            f"{number}. {question.text}\n{_as_text(question)}"
            for number, question in enumerate(self._asked, 1)
        ]
        return "\n".join([f"Quiz: {done} of {len(self._asked)} questions answered.", *rows])


class Forecast(Choices):
    """One prediction: made once, and then compared with what happens.

    Args:
        key: under which it is kept, such as `welcome.message_time`.
        prediction: what is asked.
    """

    _KIND = "prediction"
    _asked: Sequence[Prediction]

    def __init__(self, key: str, prediction: Prediction) -> None:
        super().__init__(key, [prediction])

    def _is_done(self, number: int) -> bool:
        return bool(self._tried[number])

    def _said(self, number: int) -> str:
        return inline(self._asked[number].explanation) if self._is_done(number) else ""

    def _keep(self) -> None:
        progress.keep_prediction(self.key, self._tried[0], is_right=self._is_right(0))

    def _static(self) -> str:
        prediction = self._asked[0]
        answer = f"<details><summary>What happens</summary>{inline(prediction.explanation)}</details>"
        text = f"<p><b>Predict:</b> {inline(prediction.text)}</p>{_listed(prediction)}{answer}"
        return f'<div class="{NO_FORMULA}">{text}</div>'

    def __repr__(self) -> str:
        prediction = self._asked[0]
        if not self._tried[0]:
            return f"Predict: {prediction.text}\n{_as_text(prediction)}"
        expected = prediction.options[_letters(prediction).index(self._tried[0])]
        return f"You expected: {expected}\nWhat happens: {prediction.explanation}"


def questions_of(module: str) -> tuple[tuple[Question, ...], dict[str, Prediction]]:
    """Read what a lesson asks: the questions of its quiz, and its predictions by name.

    Args:
        module: the `__name__` of the lesson's checks; `questions/LESSON.yaml` beside them holds the questions.
    """
    file = _HERE / "questions" / f"{module.rpartition('.')[2]}.yaml"
    content = yaml.safe_load(file.read_text(encoding="utf-8"))
    predictions = {
        name: Prediction(asked["question"], asked["options"], asked.get("right"), asked["explanation"])
        for name, asked in content["predictions"].items()
    }
    asked_in_quiz = (
        Question(asked["question"], asked["options"], asked["right"], asked["why"], asked["wrong"])
        for asked in content["quiz"]
    )
    return tuple(asked_in_quiz), predictions


def praise_of(questions: Sequence[Question]) -> str:
    """Return the praise for a quiz of which all is right."""
    return "Right. " + " ".join(f"({number}) {question.why}" for number, question in enumerate(questions, 1))


def predict_of(module: str, predictions: Mapping[str, Prediction]) -> Callable[[str], Forecast]:
    """Return what asks for a prediction of a lesson: `predict("message_time")`.

    Args:
        module: the `__name__` of the lesson's checks.
        predictions: by name.
    """
    lesson = module.rpartition(".")[2]

    def predict(name: str) -> Forecast:
        """Ask what the student expects, before the next cell shows it; ValueError for a name that is none."""
        if name not in predictions:
            raise ValueError(
                f"There is no prediction {name!r} in this lesson; there are {', '.join(predictions)}."
            )
        return Forecast(f"{lesson}.{name}", predictions[name])

    predict.__module__ = module
    return predict


def _letters(question: Question | Prediction) -> list[str]:
    return [chr(ord("a") + number) for number in range(len(question.options))]


def _tried(question: Question | Prediction, row: str) -> str:
    """Return what was tried, as it was kept; nothing if the question has changed since."""
    return row if set(row) <= set(_letters(question)) else ""


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _listed(question: Question | Prediction) -> str:
    options = "".join(f"<li>{inline(option)}</li>" for option in question.options)
    return f'<ol type="a">{options}</ol>'


def _as_text(question: Question | Prediction) -> str:
    pairs = zip(_letters(question), question.options, strict=True)
    return "\n".join(f"   ({letter}) {option}" for letter, option in pairs)

"""Docstrings are about code if some have a word in common with it or with the README, in whatever language."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import evidences
import pytest

from ros2lab.diagnose.sources.python_source import read_source
from ros2lab.grading.reading.described import described
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

NAMES = (
    "publish_status", "on_command", "on_timer", "set_speed", "start_robot", "stop_robot", "reset_counter",
    "make_message", "read_parameter", "spin_until_end",
)  # fmt: skip
README = "Three nodes for a small robot."


def points(texts: Sequence[str], readme: str, folder: Path) -> float:
    """Return what ten functions with these docstrings get, with a README."""
    module = "".join(
        f'def {name}(node):\n    """{text}"""\n    node.count += 1\n    node.publisher.publish(node.count)\n\n\n'
        for name, text in zip(NAMES, texts, strict=True)
    )
    (folder / "robot.py").write_text(module, encoding="utf-8")
    sources = described([read_source(folder / "robot.py", "robot", "robot.py")], (), readme)
    seen = evidences.files(sources=sources)(evidences.right())
    return next(c.points for c in verdict(seen, load()).criteria if c.id == "documentation.code")


@pytest.mark.parametrize(
    "texts",
    [
        "Tell how it goes|Obey a word|Called every two seconds|Change the speed|Go|Stay|Count from zero again"
        "|Put a text together|Look a parameter up|Go on until Ctrl-C",
        "Sendet den Status|Nimmt einen Befehl an|Wird alle zwei Sekunden gerufen|Setzt die Geschwindigkeit|Fährt los"
        "|Hält den Roboter an|Zählt wieder ab null|Baut die Nachricht|Liest den Parameter|Läuft bis Strg-C",
        "Publica el estado|Atiende una orden|Cada dos segundos|Cambia la velocidad|Arranca el robot|Para"
        "|Pone a cero|Arma el texto|Lee el valor del nodo|Gira hasta el final",
        "发布状态|接收命令|每两秒调用|设置速度|启动|停止|清零|生成消息|读取参数|运行到结束",
        "상태를 알린다|명령을 받는다|이 초마다|속도를 바꾼다|출발|정지|다시 영부터|글을 만든다|값을 읽는다|끝까지 돈다",
    ],
    ids=["English", "German", "Spanish", "Chinese", "Korean"],
)
def test_words_in_any_language_are_about_it(texts: str, tmp_path: Path) -> None:
    assert points(texts.split("|"), README, tmp_path) == 3


def test_words_of_the_readme_are_about_it(tmp_path: Path) -> None:
    texts = ["Lähettää tilan", "Ottaa käskyn", "Kahden sekunnin välein", "Muuttaa nopeutta", "Lähtee"]
    said = "Solmu lähettää kahden sekunnin välein tilan ja muuttaa nopeutta."
    assert points([*texts, "Pysähtyy", "Nollaa", "Kokoaa", "Lukee", "Pyörii"], said, tmp_path) == 3


@pytest.mark.parametrize(
    "texts",
    [
        "Lorem ipsum dolor|Sit amet elit|Sed do eiusmod|Tempor incididunt|Ut labore|Et dolore magna|Aliqua enim"
        "|Ad minim veniam|Quis nostrud|Duis aute irure",
        "asdf qwer|qwer zxcv|zxcv uiop|uiop hjkl|hjkl vbnm|vbnm tyui|tyui ghjk|ghjk bnmq|bnmq werp|werp asdd",
        "One|Two|Three|Four|Five|Six|Seven|Eight|Nine|Ten",
    ],
    ids=["lorem ipsum", "mashed keys", "a count"],
)
def test_words_about_nothing_here_are_not(texts: str, tmp_path: Path) -> None:
    assert points(texts.split("|"), README, tmp_path) == 1

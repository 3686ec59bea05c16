// Questions that are answered with a click: a quiz asks one after the other, a prediction asks once.
// Python knows the answers: it is sent a choice, and answers with new states, which are drawn here.

const PATIENCE = 1000; // ms, until a choice is sent again
// On what has the focus: its keys choose and press here, and not JupyterLab's cells.
const OWN_KEYS = 'data-lm-suppress-shortcuts="true"';
const LETTERS = "abcdefghij";
let groups = 0; // radio buttons belong together by their name

function render({ model, el }) {
  el.classList.add("ros2lab-choices");
  const isQuiz = model.get("kind") === "quiz";
  const questions = model.get("questions");
  const group = `ros2lab-choices-${groups++}`;
  el.innerHTML = `<div class="ros2lab-asked"></div>
    <div class="ros2lab-spoken" role="status" aria-live="polite"></div>
    <div class="ros2lab-gone">Run this cell again to answer.</div>`;
  const [body, spoken] = [".ros2lab-asked", ".ros2lab-spoken"].map((selector) => el.querySelector(selector));

  let isWaiting = false; // for the answer to a click, so that the keyboard goes on where it was

  function draw() {
    const states = model.get("states");
    const current = states.findIndex((state) => !state.is_done);
    const last = current < 0 ? questions.length - 1 : current;
    const blocks = questions.slice(0, last + 1).map((question, i) => {
      const title = isQuiz ? `Question ${i + 1} of ${questions.length}` : "Predict";
      return states[i].is_done ? answered(title, question, states[i]) : open(title, question, states[i], i);
    });
    const done = isQuiz && current < 0 ? `<p class="ros2lab-all"><i class="ros2lab-right" aria-hidden="true">✔</i> All ${questions.length} questions are answered.</p>` : "";
    body.innerHTML = blocks.join("") + done;
    const form = body.querySelector("form");
    if (!form) return;
    const button = form.querySelector("button");
    form.addEventListener("change", () => (button.disabled = false));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const chosen = form.querySelector("input:checked");
      if (!chosen) return;
      isWaiting = button.disabled = true;
      send({ question: current, letter: chosen.value }, PATIENCE, form);
    });
  }

  // JupyterLab may lose a message right after a page is loaded, so send until there is an answer.
  function send(choice, patience, form) {
    if (!form.isConnected || model.get("states")[choice.question].tried.includes(choice.letter)) return;
    if (patience > PATIENCE) form.querySelector(".ros2lab-busy").textContent = "The answer comes when the running cell has ended.";
    model.send(choice);
    setTimeout(() => send(choice, 2 * patience, form), patience);
  }

  function open(title, question, state, i) {
    const options = question.options.map((option, k) => {
      const isTried = state.tried.includes(LETTERS[k]);
      const mark = isTried ? `<i class="ros2lab-wrong" aria-hidden="true">✗</i><span class="ros2lab-unseen">not this one: </span>` : "";
      return `<label class="${isTried ? "ros2lab-tried" : ""}"><input type="radio" ${OWN_KEYS} name="${group}-${i}" value="${LETTERS[k]}"
        ${isTried ? "disabled" : ""}>${mark}<span>${option}</span></label>`;
    });
    const nudge = state.said ? `<p class="ros2lab-said ros2lab-nudge"><b>Not yet.</b> ${state.said}</p>` : "";
    return `<form><fieldset><legend><b>${title}</b> ${question.text}</legend>${options.join("")}</fieldset>${nudge}
      <button type="submit" ${OWN_KEYS} class="jp-mod-styled jp-mod-accept" disabled>${isQuiz ? "Answer" : "Commit"}</button>
      <span class="ros2lab-busy" role="status"></span></form>`;
  }

  function answered(title, question, state) {
    const chosen = question.options[LETTERS.indexOf(state.tried.at(-1))];
    const mark = state.is_right === null ? "" : state.is_right
      ? `<i class="ros2lab-right" aria-hidden="true">✔</i> <b>${isQuiz ? "Right:" : "You were right."}</b>`
      : `<i class="ros2lab-wrong" aria-hidden="true">✗</i> <b>It turns out differently.</b>`;
    if (isQuiz) {
      return `<section><p><b>${title}</b> ${question.text}</p><p>${mark} ${chosen}</p>
        <p class="ros2lab-said">${state.said}</p></section>`;
    }
    return `<section><p><b>${title}</b> ${question.text}</p><p>You expected: ${chosen} &nbsp; ${mark}</p>
      <p class="ros2lab-said"><b>What happens:</b> ${state.said}</p></section>`;
  }

  function showStates() {
    const hadFocus = isWaiting || el.contains(document.activeElement);
    isWaiting = false;
    const before = body.querySelectorAll("section").length;
    draw();
    const sections = body.querySelectorAll("section");
    const news = sections.length > before ? sections[sections.length - 1].textContent : body.querySelector(".ros2lab-nudge")?.textContent;
    spoken.textContent = news ?? "";
    if (!hadFocus) return;
    const next = body.querySelector("input:not(:disabled)");
    if (next) return next.focus({ preventScroll: true });
    el.tabIndex = -1;
    el.focus({ preventScroll: true });
  }

  model.on("change:states", showStates);
  draw();
  return () => model.off("change:states", showStates);
}

export default { render };

// Shows the newest message of a topic as a tree whose branches stay open or folded while values change.
// Python sends the newest message five times a second at most; its age goes on here.

const MARKED = 1000; // ms for which a changed value is marked
const AGE_PERIOD = 200; // ms
const PATIENCE = 45; // ms for which what has come waits for a frame that another view draws

// Called once a model: its views share the message and what is folded.
export default () => {
  const clock = () => performance.now() / 1000; // s
  const state = { message: null, cameAt: null, isSaved: false, isWhole: false, clickedAt: -Infinity };
  const seenBy = audience();
  const folds = new Map(); // by path: whether somebody opened or folded it

  function initialize({ model }) {
    const saved = model.get("saved");
    if (saved) {
      // From a notebook whose kernel has gone.
      Object.assign(state, { message: saved.message, isSaved: true });
      seenBy.beAlone();
      return;
    }
    // Read when JupyterLab saves the notebook, and not before; Python knows nothing of it.
    model.set("saved", { get message() { return state.message; } });
    model.on("msg:custom", (message) => {
      state.isWhole ||= message.is_whole;
      // A page that comes back to a monitor that stands still gets a message, but no other one.
      if (model.get("paused") && state.message) return;
      state.message = message;
      state.cameAt = message.age === null ? null : clock() - message.age;
    });
    askFor("message", model, state);
  }

  function render({ model, el }) {
    el.classList.add("ros2lab-card", "ros2lab-monitor");
    const figure = (key, name, unit) => `<div><span>${name}</span><b data-value="${key}">–</b> ${unit}</div>`;
    el.innerHTML = `
      <div class="ros2lab-head"><span class="ros2lab-title">Monitor</span> <code></code> <code></code>
        <span class="ros2lab-news"></span><button type="button" class="jp-mod-styled"></button></div>
      <div class="ros2lab-figures">${figure("rate", "rate", "Hz")}${figure("jitter", "jitter", "ms")}
        ${figure("size", "size", "bytes")}${figure("count", "messages", "")}${figure("age", "last one", "s ago")}</div>
      <div class="ros2lab-note" role="status"></div>
      <div class="ros2lab-tree" role="group"></div>`;
    const [topic, type] = el.querySelectorAll("code");
    const [news, button, note, tree] =
      [".ros2lab-news", "button", ".ros2lab-note", ".ros2lab-tree"].map((selector) => el.querySelector(selector));
    const root = branches(tree, folds);
    button.disabled = state.isSaved;

    const show = (key, text) => write(el.querySelector(`[data-value=${key}]`), text);
    const screen = onScreen(model, el, seenBy, draw, (isSeen) => {
      // Pausing stores a picture, for which JupyterLab makes the view anew: the keyboard stays on its button.
      if (isSeen && clock() - state.clickedAt < 5 && document.activeElement === document.body) button.focus();
    });

    function draw() {
      const message = state.message;
      if (message?.tree) root.show(message.tree, "");
      show("jitter", decimals(message?.jitter == null ? null : 1000 * message.jitter));
      show("size", message?.size == null ? "–" : thousands(message.size));
      show("count", thousands(message?.count ?? 0));
      showAge();
    }

    function showAge() {
      const isPaused = model.get("paused") || state.isSaved;
      const age = isPaused ? state.message?.age ?? null : state.cameAt === null ? null : clock() - state.cameAt;
      const isSilent = !isPaused && (age === null || age > state.message.patience);
      show("rate", isSilent ? "–" : decimals(state.message?.rate));
      show("age", age === null ? "–" : age.toFixed(1));
      const text = state.isSaved ? "as it was when its kernel ended" : isPaused ? "paused"
        : age === null ? "no message yet" : isSilent ? "silent" : "live";
      write(news, text);
      news.classList.toggle("ros2lab-silent", isSilent);
      // It grows older when no message comes.
      if (!isPaused) screen.ask({ after: AGE_PERIOD, within: PATIENCE });
    }

    function showNames() {
      topic.textContent = model.get("topic");
      type.textContent = model.get("type_name");
      tree.setAttribute("aria-label", `Newest message on ${model.get("topic")}, ${model.get("type_name") || "type unknown"}`);
      note.textContent = state.isSaved ? "" : model.get("note");
      button.textContent = model.get("paused") ? "Resume" : "Pause";
      screen.ask();
    }

    button.addEventListener("click", () => {
      state.clickedAt = clock();
      model.set("paused", !model.get("paused"));
      model.save_changes();
    });
    const receive = () => screen.ask({ within: PATIENCE });
    model.on("msg:custom", receive);
    const named = ["paused", "note", "type_name"].map((name) => `change:${name}`);
    for (const change of named) model.on(change, showNames);
    showNames();
    return () => {
      screen.end();
      model.off("msg:custom", receive);
      for (const change of named) model.off(change, showNames);
    };
  }

  return { initialize, render };
};

// The fields below one branch. Elements are kept while the fields are the same, so that nothing jumps or unfolds.
function branches(place, folds) {
  let rows = [], shape = null;

  function show(branch, path) {
    const children = branch.children ?? [], leftOut = branch.left_out ?? 0;
    const newShape = JSON.stringify([children.map((child) => [child.name, child.type, isBranch(child)]), leftOut > 0]);
    if (newShape !== shape) build(children, leftOut, path);
    shape = newShape;
    children.forEach((child, i) => rows[i].show(child, `${path}/${child.name}`));
    const more = place.querySelector(":scope > ul > .ros2lab-more");
    if (more) more.textContent = `… ${thousands(leftOut)} more`;
  }

  function build(children, leftOut, path) {
    const list = document.createElement("ul");
    rows = children.map((child) => row(list, child, `${path}/${child.name}`, folds));
    if (leftOut) list.append(Object.assign(document.createElement("li"), { className: "ros2lab-more" }));
    place.replaceChildren(list);
  }

  return { show };
}

const isBranch = (field) => Boolean(field.children?.length || field.left_out);
const isArray = (field) => field.type.endsWith("]");

// One field: a line, and what is below it once it is unfolded.
function row(list, field, path, folds) {
  const item = list.appendChild(document.createElement("li"));
  const details = isBranch(field) ? item.appendChild(document.createElement("details")) : null;
  const line = (details ?? item).appendChild(document.createElement(details ? "summary" : "div"));
  line.className = "ros2lab-row";
  line.innerHTML = `<span class="ros2lab-mark" aria-hidden="true"></span><span class="ros2lab-name"></span>
    <span class="ros2lab-value"></span><span class="ros2lab-type"></span>`;
  const [, name, value, type] = line.children;
  name.textContent = field.name;
  type.textContent = field.type;
  let text = null, timer = 0, newest = field, below = null;

  function showBelow() {
    if (!details?.open) return;
    below ??= branches(details.appendChild(document.createElement("div")), folds);
    below.show(newest, path);
  }

  if (details) {
    const depth = path.split("/").length - 1;
    details.open = folds.get(path) ?? (!isArray(field) && depth <= 3 && !field.type.startsWith("builtin_interfaces/"));
    let isOpen = details.open;
    details.addEventListener("toggle", () => {
      if (details.open !== isOpen) folds.set(path, details.open);
      isOpen = details.open;
      line.classList.toggle("ros2lab-open", isOpen && !isArray(field));
      showBelow();
    });
  }

  function show(next) {
    newest = next;
    if (next.text !== text) {
      value.textContent = next.text;
      if (text !== null) mark();
      text = next.text;
    }
    showBelow();
  }

  function mark() {
    line.classList.add("ros2lab-changed");
    clearTimeout(timer);
    timer = setTimeout(() => line.classList.remove("ros2lab-changed"), MARKED);
  }

  return { show };
}

const decimals = (value) => (value == null ? "–" : value >= 100 ? value.toFixed(0) : value.toFixed(value >= 10 ? 1 : 2));
const thousands = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");

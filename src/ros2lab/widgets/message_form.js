// A form for a message. What was typed goes to Python as a whole; Python checks it, publishes it, or says which
// fields are wrong.

const ALIVE_PERIOD = 1000; // ms between two signs of life while something is published by itself
const GRACE = 3000; // ms without a view, after which the form is taken for gone: JupyterLab makes views anew
const GRID_FROM = 4; // elements of an array of numbers that stand side by side

// Called once a model: a view that JupyterLab makes anew has what was typed in the last one.
export default () => {
  const state = { values: null, rate: "1", problems: {}, views: 0, number: Math.floor(1e9 * Math.random()), isSaved: false, isOpen: new Map() };
  let goneTimer = 0;

  function initialize({ model }) {
    const saved = model.get("saved");
    state.values = saved?.values ?? initial({ kind: "message", fields: model.get("fields") });
    state.isSaved = Boolean(saved);
    if (saved) return;
    // Read when JupyterLab saves the notebook, and not before; Python knows nothing of it.
    model.set("saved", { get values() { return state.values; } });
    model.on("msg:custom", (message) => message.answer === state.number && (state.problems = message.problems));
    const isPublishing = () => model.get("publishing_rate") > 0;
    const stop = () => isPublishing() && model.send({ do: "stop" });
    const timer = setInterval(() => isPublishing() && model.send({ do: "nothing" }), ALIVE_PERIOD);
    addEventListener("pagehide", stop);
    state.stop = stop;
    return () => {
      clearInterval(timer);
      removeEventListener("pagehide", stop);
    };
  }

  function render({ model, el }) {
    state.views += 1;
    clearTimeout(goneTimer);
    const [least, most] = model.get("rate_range");
    el.classList.add("ros2lab-card", "ros2lab-form");
    el.innerHTML = `
      <div class="ros2lab-head"><span class="ros2lab-title">Publish</span> <code></code> <code></code><span class="ros2lab-news"></span></div>
      <form novalidate><div class="ros2lab-fields"></div>
        <div class="ros2lab-bar"><button type="submit" class="jp-mod-styled jp-mod-accept">Publish once</button>
          <label>at <input class="ros2lab-rate jp-mod-styled" inputmode="decimal" autocomplete="off"
            title="from ${least} to ${most} Hz"> Hz</label>
          <button type="button" class="ros2lab-repeat jp-mod-styled">Start</button>
          <span class="ros2lab-result" role="status"></span></div></form>`;
    const [topic, type] = el.querySelectorAll("code");
    const [news, form, place, rate, repeat, result] = [".ros2lab-news", "form", ".ros2lab-fields",
      ".ros2lab-rate", ".ros2lab-repeat", ".ros2lab-result"].map((selector) => el.querySelector(selector));
    [topic.textContent, type.textContent] = [model.get("topic"), model.get("type_name")];
    rate.value = state.rate;
    const context = { state, id: `ros2lab-form-${Math.random().toString(36).slice(2)}`, cells: new Map() };
    fields(place, model.get("fields"), state.values, "", context);
    if (state.isSaved) for (const control of el.querySelectorAll("input, button, select")) control.disabled = true;

    function send(action) {
      state.number += 1;
      context.number = state.number;
      result.textContent = "Waiting for the kernel …";
      result.classList.remove("ros2lab-reason");
      model.send({ do: action, number: state.number, values: state.values, rate: Number(state.rate || NaN) });
    }

    function showAnswer(message) {
      if (message.answer !== state.number) return;
      const problems = Object.entries(message.problems);
      for (const [path, cell] of context.cells) cell.refuse(message.problems[path] ?? "");
      const elsewhere = problems.filter(([path]) => !context.cells.has(path)).map(([, sentence]) => sentence);
      const count = problems.length - elsewhere.length;
      const fieldsText = count ? [`Nothing was published: ${count === 1 ? "a field needs" : `${count} fields need`} another value.`] : [];
      result.classList.toggle("ros2lab-reason", problems.length > 0);
      if (problems.length) result.textContent = [...elsewhere, ...fieldsText].join(" ");
      else showSent();
      const first = [...context.cells].find(([path]) => message.problems[path]);
      if (first && context.number === message.answer) first[1].focus();
    }

    function showSent() {
      const sent = model.get("sent"), every = model.get("publishing_rate");
      const texts = sent ? [`${sent} published`] : [];
      if (every) texts.unshift(`Publishing at ${every} Hz`);
      if (!result.classList.contains("ros2lab-reason")) result.textContent = texts.join(" · ");
      repeat.textContent = every ? "Stop" : "Start";
      repeat.classList.toggle("jp-mod-warn", every > 0);
      el.classList.toggle("ros2lab-publishing", every > 0);
    }

    function showListeners() {
      const count = model.get("listeners");
      news.textContent = state.isSaved ? "as it was when its kernel ended"
        : count ? `${count} ${count === 1 ? "node listens" : "nodes listen"}` : "nobody listens yet";
      news.classList.toggle("ros2lab-silent", !count && !state.isSaved);
    }

    form.addEventListener("submit", (event) => {
      event.preventDefault();
      send("publish");
    });
    // Enter publishes, also from a field before which the browser finds another button.
    form.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.isComposing || event.target.tagName !== "INPUT") return;
      event.preventDefault();
      if (!state.isSaved) send("publish");
    });
    rate.addEventListener("input", () => (state.rate = rate.value.trim()));
    repeat.addEventListener("click", () => (model.get("publishing_rate") ? model.send({ do: "stop" }) : send("start")));
    model.on("msg:custom", showAnswer);
    for (const name of ["sent", "publishing_rate"]) model.on(`change:${name}`, showSent);
    model.on("change:listeners", showListeners);
    showListeners();
    showSent();
    for (const [path, cell] of context.cells) cell.refuse(state.problems[path] ?? "");
    return () => {
      state.views -= 1;
      if (!state.views) goneTimer = setTimeout(() => state.views || state.stop?.(), GRACE);
    };
  }

  return { initialize, render };
};

function initial(field) {
  if (field.kind === "message" || field.kind === "time")
    return Object.fromEntries(field.fields.map((below) => [below.name, initial(below)]));
  if (field.kind === "array") return field.default.map((value) => value ?? initial(field.item));
  return field.default;
}

function element(place, tag, properties = {}) {
  return place.appendChild(Object.assign(document.createElement(tag), properties));
}

function fields(place, list, values, where, context) {
  for (const field of list) {
    const path = where ? `${where}.${field.name}` : field.name;
    entry(place, field, values, field.name, path, field.name, context);
  }
}

// One field or element: `values[key]` is what it holds.
function entry(place, field, values, key, path, name, context) {
  if (field.kind === "array") arrayEntry(place, field, values, key, path, name, context);
  else if (field.kind === "message" || field.kind === "time") messageEntry(place, field, values, key, path, name, context);
  else leafEntry(place, field, values, key, path, name, context);
}

function fold(place, field, path, name, isOpen, context) {
  const details = element(place, "details", { className: "ros2lab-group" });
  const summary = element(details, "summary");
  element(summary, "span", { className: "ros2lab-name", textContent: name });
  element(summary, "span", { className: "ros2lab-type", textContent: ` ${field.type}${field.unit ? ` in ${field.unit}` : ""}` });
  details.open = context.state.isOpen.get(path) ?? isOpen;
  details.addEventListener("toggle", () => context.state.isOpen.set(path, details.open));
  if (field.comment) element(details, "div", { className: "ros2lab-comment", textContent: field.comment });
  return details;
}

function messageEntry(place, field, values, key, path, name, context) {
  const details = fold(place, field, path, name, field.kind !== "time", context);
  const below = element(details, "div", { className: "ros2lab-below" });
  if (field.kind === "time") {
    const label = element(below, "label", { className: "ros2lab-now" });
    const box = element(label, "input", { type: "checkbox", checked: values[key] === "now" });
    label.append(" the time of publishing");
    const parts = element(below, "div");
    const show = () => {
      parts.replaceChildren();
      for (const cell of [...context.cells.keys()]) if (cell.startsWith(`${path}.`)) context.cells.delete(cell);
      if (values[key] !== "now") fields(parts, field.fields, values[key], path, context);
    };
    box.addEventListener("change", () => {
      values[key] = box.checked ? "now" : initial(field);
      show();
    });
    show();
    return;
  }
  fields(below, field.fields, values[key], path, context);
}

function arrayEntry(place, field, values, key, path, name, context) {
  const items = values[key];
  const details = fold(place, field, path, name, items.length > 0 && items.length < GRID_FROM, context);
  const count = element(details.firstChild, "span", { className: "ros2lab-count" });
  const note = element(details, "div", { className: "ros2lab-problem" });
  const isPlain = !["message", "time", "array"].includes(field.item.kind);
  const list = element(details, "div", { className: `ros2lab-below ${isPlain ? "ros2lab-items" : ""}` });
  const isResizable = field.size === null;
  const add = isResizable && element(details, "button", {
    type: "button", className: "ros2lab-add jp-mod-styled", textContent: "+ add an element" });

  function build() {
    for (const cell of [...context.cells.keys()]) if (cell.startsWith(`${path}[`)) context.cells.delete(cell);
    list.replaceChildren();
    count.textContent = ` · ${items.length} element${items.length === 1 ? "" : "s"}`;
    if (add) add.disabled = field.most !== null && items.length >= field.most;
    items.forEach((_, n) => {
      const holder = element(list, "div", { className: "ros2lab-item" });
      entry(holder, field.item, items, n, `${path}[${n}]`, `[${n}]`, context);
      if (!isResizable) return;
      const remove = element(holder, "button", { type: "button", className: "ros2lab-remove jp-mod-styled", textContent: "×" });
      remove.title = `remove ${name}[${n}]`;
      remove.setAttribute("aria-label", remove.title);
      remove.addEventListener("click", () => {
        items.splice(n, 1);
        build();
        (list.querySelectorAll(":scope > .ros2lab-item > .ros2lab-remove")[Math.min(n, items.length - 1)] ?? add).focus();
      });
    });
  }

  add?.addEventListener?.("click", () => {
    items.push(initial(field.item));
    build();
    list.lastElementChild.querySelector("input, select, summary")?.focus();
  });
  context.cells.set(path, {
    refuse: (sentence) => {
      note.textContent = sentence;
      if (sentence) details.open = true;
    },
    focus: () => details.firstChild.focus(),
  });
  build();
}

function leafEntry(place, field, values, key, path, name, context) {
  const id = `${context.id}-${path}`;
  const line = element(place, "div", { className: "ros2lab-entry" });
  const label = element(line, "label", { className: "ros2lab-name", htmlFor: id, textContent: name });
  const input = element(line, "input", { id, autocomplete: "off", spellcheck: false });
  const isBool = field.kind === "bool";
  input.type = isBool ? "checkbox" : "text";
  if (!isBool) input.className = "jp-mod-styled";
  if (field.kind === "int" || field.kind === "float") input.inputMode = field.kind === "int" ? "numeric" : "decimal";
  if (isBool) input.checked = values[key];
  else input.value = values[key];
  input.title = field.kind === "int" ? `${field.type}: a whole number from ${field.low} to ${field.high}` : field.type;
  label.title = path;
  element(line, "span", { className: "ros2lab-unit", textContent: field.unit });
  element(line, "span", { className: "ros2lab-type", textContent: field.type });
  const constant = offerOptions(line, input, field, id);
  const isElement = name.startsWith("[");
  if (field.comment && !isElement) element(line, "div", { className: "ros2lab-comment", id: `${id}-comment`, textContent: field.comment });
  const note = element(line, "div", { className: "ros2lab-problem", id: `${id}-problem` });
  const described = () => [field.comment && !isElement ? `${id}-comment` : "", note.textContent ? note.id : ""].filter(Boolean).join(" ");

  function refuse(sentence) {
    note.textContent = sentence;
    line.classList.toggle("ros2lab-refused", Boolean(sentence));
    input.setAttribute("aria-invalid", String(Boolean(sentence)));
    input.setAttribute("aria-describedby", described());
    if (sentence) for (let up = line.closest("details"); up; up = up.parentElement.closest("details")) up.open = true;
  }

  input.addEventListener("input", () => {
    values[key] = isBool ? input.checked : input.value;
    delete context.state.problems[path];
    refuse("");
    constant();
  });
  context.cells.set(path, { refuse, focus: () => input.focus() });
  refuse("");
}

// The constants of the message, to choose from; another value may be typed all the same.
function offerOptions(line, input, field, id) {
  if (!field.options?.length) return () => {};
  const list = element(line, "datalist", { id: `${id}-options` });
  for (const [name, value] of field.options) element(list, "option", { value, label: `${name} = ${value}` });
  input.setAttribute("list", list.id);
  const named = element(line, "span", { className: "ros2lab-constant" });
  const show = () => (named.textContent = field.options.find(([, value]) => value === input.value.trim())?.[0] ?? "");
  show();
  return show;
}

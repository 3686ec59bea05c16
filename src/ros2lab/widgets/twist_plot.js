// Draws linear x and angular z of a Twist topic against time.
// Python sends each sample once, as three float64 (s, m/s, rad/s); what is on the screen is kept here.

const SERIES = [
  { name: "linear x", unit: "m/s", column: 1, key: "linear" },
  { name: "angular z", unit: "rad/s", column: 2, key: "angular" },
];
const LEFT = 58, RIGHT = 10, TOP = 6, BOTTOM = 34, BETWEEN = 16;
const MOST_SAVED = 2000; // samples, in a saved notebook
const SPOKEN_PERIOD = 2000; // ms between two texts for screen readers

// Called once a model: its views share the samples, and a new view finds them all.
export default () => {
  const clock = () => performance.now() / 1000; // s
  const state = { samples: [], offset: -clock(), isWhole: false, isSaved: false, pausedAt: null, clickedAt: -Infinity, moment: null };
  const now = () => clock() + state.offset; // s, on Python's clock

  function initialize({ model }) {
    if (model.get("span")) {
      state.samples = rowsOf(model.get("recorded"), 3);
      return;
    }
    const saved = model.get("saved");
    if (saved) {
      // From a notebook whose kernel has gone: it stands still where it was.
      Object.assign(state, { samples: saved.samples, pausedAt: saved.now, isSaved: true });
      return;
    }
    // Read when JupyterLab saves the notebook, and not before; Python knows nothing of it.
    model.set("saved", {
      get now() { return state.pausedAt ?? now(); },
      get samples() { return newest(state.samples, this.now - model.get("window")); },
    });
    model.on("msg:custom", (message, [buffer]) => {
      const { byteOffset: at, byteLength: length } = buffer;
      const numbers = new Float64Array(buffer.buffer.slice(at, at + length));
      if (message.is_whole) [state.samples, state.isWhole] = [[], true];
      for (let i = 0; i < numbers.length; i += 3) state.samples.push(numbers.slice(i, i + 3));
      const oldest = message.now - message.kept;
      const first = state.samples.findIndex((sample) => sample[0] >= oldest);
      if (first > 0) state.samples.splice(0, first);
      state.offset = message.now - clock();
      if (model.get("paused")) state.pausedAt ??= now();
    });
    model.on("change:paused", () => (state.pausedAt = model.get("paused") ? now() : null));
    askForSamples(model, 500);
  }

  // JupyterLab may lose a message right after a page is loaded, so ask until there is an answer.
  function askForSamples(model, patience) {
    if (state.isWhole) return;
    model.send({ ask: "samples" });
    setTimeout(() => askForSamples(model, 2 * patience), patience);
  }

  function render({ model, el }) {
    el.classList.add("ros2lab-card", "ros2lab-plot");
    return model.get("span") ? renderRecorded(model, el) : renderLive(model, el);
  }

  function renderRecorded(model, el) {
    const span = model.get("span"), name = model.get("recording"), topic = model.get("topic");
    el.innerHTML = page("");
    el.querySelector("code").textContent = topic;
    el.querySelector(".ros2lab-news").textContent = `recorded: ${name}`;
    const svg = el.querySelector(".ros2lab-canvas"), gap = longestGap(state.samples, state.samples.length);
    let spokenAt = -Infinity;

    function show(moment) {
      const last = state.samples[rowAt(state.samples, moment)], isThere = last[0] <= moment && moment - last[0] <= gap;
      const values = tell(el, isThere ? last : null);
      const across = LEFT + (moment / span) * (svg.clientWidth - RIGHT - LEFT);
      svg.querySelector(".ros2lab-cursor")?.setAttribute("d", `M${across} ${TOP}V${svg.clientHeight - BOTTOM}`);
      if (performance.now() - spokenAt < SPOKEN_PERIOD) return;
      spokenAt = performance.now();
      svg.setAttribute("aria-label", `Plot of ${topic} against time, recorded; at ${moment.toFixed(1)} s: ${values}.`);
    }

    function draw() {
      if (!el.isConnected || !svg.clientWidth) return;
      svg.innerHTML = `${picture(state.samples, 0, span, span, gap, svg)}<path class="ros2lab-cursor"/>`;
      show(state.moment);
    }

    const leave = timeline(el, { name, span }, state, show);
    const resized = new ResizeObserver(draw);
    resized.observe(svg);
    return () => {
      leave();
      resized.disconnect();
    };
  }

  function renderLive(model, el) {
    const [least, most] = model.get("window_range");
    el.innerHTML = page(`
        <label>window <input type="number" class="jp-mod-styled" min="${least}" max="${most}" step="1"> s</label>
        <button type="button" class="jp-mod-styled"></button>`);
    const [topic, news, input, button, svg] =
      ["code", ".ros2lab-news", "input", "button", ".ros2lab-canvas"].map((selector) => el.querySelector(selector));
    topic.textContent = model.get("topic");
    const isSaved = state.isSaved;
    input.disabled = button.disabled = isSaved;
    let drawnAt = 0, spokenAt = 0;

    function draw() {
      if (!el.isConnected || !svg.clientWidth) return;
      drawnAt = performance.now();
      const end = state.pausedAt ?? now(), window = model.get("window"), gap = longestGap(state.samples);
      const begin = Math.max(0, end - window);
      svg.innerHTML = picture(state.samples, begin, begin + window, end, gap, svg);
      const last = state.samples.findLast((sample) => sample[0] <= end);
      const values = tell(el, last);
      const isPaused = model.get("paused") || isSaved;
      news.textContent = isSaved ? "as it was when its kernel ended" : report(state.samples, last, end, gap, isPaused);
      news.classList.toggle("ros2lab-silent", !isPaused && !(last && end - last[0] < gap));
      if (drawnAt - spokenAt < SPOKEN_PERIOD) return;
      spokenAt = drawnAt;
      svg.setAttribute("aria-label", `Plot of ${topic.textContent} against time: ${values}; ${news.textContent}.`);
    }

    function showControls() {
      input.value = model.get("window");
      button.textContent = model.get("paused") ? "Resume" : "Pause";
      spokenAt = 0;
      draw();
    }

    input.addEventListener("change", () => {
      const wanted = Math.min(most, Math.max(least, input.valueAsNumber || model.get("window")));
      model.set("window", wanted);
      model.save_changes();
      showControls();
    });
    button.addEventListener("click", () => {
      state.clickedAt = clock();
      model.set("paused", !model.get("paused"));
      model.save_changes();
    });
    model.on("msg:custom", draw);
    model.on("change:window", showControls);
    model.on("change:paused", showControls);
    const resized = new ResizeObserver(() => {
      draw();
      // Pausing stores a picture, for which JupyterLab makes the view anew: the keyboard stays on its button.
      if (clock() - state.clickedAt < 5 && document.activeElement === document.body) button.focus();
    });
    resized.observe(svg);
    // The time goes on when no message comes.
    const period = 1000 / model.get("rate");
    const timer = setInterval(() => performance.now() - drawnAt > 0.9 * period && draw(), period);
    showControls();
    return () => {
      clearInterval(timer);
      resized.disconnect();
    };
  }

  return { initialize, render };
};

function page(controls) {
  const entry = (s) => `<span><svg width="30" height="10" aria-hidden="true"><path class="ros2lab-${s.key}" d="M1 5H29"/></svg>
    ${s.name} <b data-value="${s.key}"></b> ${s.unit}</span>`;
  return `
    <div class="ros2lab-head"><span class="ros2lab-title">Twist</span> <code></code>
      <span class="ros2lab-news"></span>${controls}</div>
    <div class="ros2lab-legend">${SERIES.map(entry).join("")}</div>
    <svg class="ros2lab-canvas" role="img"></svg>`;
}

// Shows the values of a sample, if there is one, and returns them in words.
function tell(el, sample) {
  const value = (s) => (sample ? sample[s.column].toFixed(2).replace("-", "−") : "–");
  for (const s of SERIES) el.querySelector(`[data-value=${s.key}]`).textContent = value(s);
  return SERIES.map((s) => `${s.name} ${value(s)} ${s.unit}`).join(", ");
}

function newest(samples, begin) {
  return samples.filter((sample) => sample[0] > begin).slice(-MOST_SAVED).map((sample) => Array.from(sample));
}

// A silence longer than this (s) is drawn as one: the values are not held over it.
function longestGap(samples, count = 30) {
  const recent = samples.slice(-count);
  const gaps = recent.slice(1).map((sample, i) => sample[0] - recent[i][0]).sort((a, b) => a - b);
  return Math.max(1, 4 * (gaps[gaps.length >> 1] ?? 0));
}

function report(samples, last, end, gap, isPaused) {
  if (isPaused) return "paused";
  if (!last) return "no message yet";
  if (end - last[0] >= gap) return `no message for ${(end - last[0]).toFixed(1)} s`;
  const recent = samples.filter((sample) => sample[0] > end - 3);
  const span = recent.length ? recent.at(-1)[0] - recent[0][0] : 0;
  return span > 0 ? `${((recent.length - 1) / span).toFixed(1)} Hz` : "";
}

// One panel a series, one above the other, over the same time: their units differ.
function picture(samples, begin, until, end, gap, { clientWidth: width, clientHeight: height }) {
  const right = width - RIGHT, bottom = height - BOTTOM;
  const x = (time) => LEFT + (Math.max(0, time - begin) / (until - begin)) * (right - LEFT);
  const panelHeight = (height - TOP - BOTTOM - BETWEEN) / 2;
  // The last one before the window holds into it.
  const shown = samples.filter((sample, i) => sample[0] <= end && (samples[i + 1]?.[0] ?? sample[0] + gap) >= begin);
  const times = ticks(begin, until, Math.max(2, width / 90));
  const panels = SERIES.map((s, i) => {
    const top = TOP + i * (panelHeight + BETWEEN);
    const [low, high] = limits(shown, s.column);
    const y = (value) => top + ((high - value) / (high - low)) * panelHeight;
    const levels = ticks(low, high, 3).map((level) => `<path class="ros2lab-grid" d="M${LEFT} ${y(level)}H${right}"/>
      <text x="${LEFT - 6}" y="${y(level) + 4}" text-anchor="end">${label(level)}</text>`);
    const marks = times.map((time) => `<path class="ros2lab-grid" d="M${x(time)} ${top}v${panelHeight}"/>`);
    return `${levels.join("")}${marks.join("")}
      <rect x="${LEFT}" y="${top}" width="${right - LEFT}" height="${panelHeight}"/>
      <path class="ros2lab-${s.key}" d="${steps(shown, s.column, x, y, gap, end)}"/>
      <text class="ros2lab-axis" transform="translate(12 ${top + panelHeight / 2}) rotate(-90)" text-anchor="middle">
        ${s.name}<tspan x="0" dy="1.2em">(${s.unit})</tspan></text>`;
  });
  const names = times.map((time) => `<text x="${x(time)}" y="${bottom + 15}" text-anchor="middle">${label(time)}</text>`);
  return `${panels.join("")}${names.join("")}
    <text class="ros2lab-axis" x="${(LEFT + right) / 2}" y="${height - 4}" text-anchor="middle">time (s)</text>`;
}

// A command holds until the next one: steps, drawn where something changes, broken where nothing came.
function steps(samples, column, x, y, gap, end) {
  let path = "", before = null, level = null;
  for (const sample of samples) {
    const [across, up] = [x(sample[0]).toFixed(1), y(sample[column]).toFixed(1)];
    if (before === null) path = `M${across} ${up}h1`;
    else if (sample[0] - before > gap) path += `H${x(before).toFixed(1)}M${across} ${up}h1`;
    else if (up !== level) path += `H${across}V${up}`;
    [before, level] = [sample[0], up];
  }
  return before === null ? "" : `${path}H${x(end - before > gap ? before : end).toFixed(1)}`;
}

// The range of the values and zero, and a little more.
function limits(samples, column) {
  let low = 0, high = 0;
  for (const sample of samples) [low, high] = [Math.min(low, sample[column]), Math.max(high, sample[column])];
  const room = 0.1 * (high - low) || 1;
  return [low - room, high + room];
}

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= 0.99 * rough) * power;
  const first = Math.ceil(low / step), length = Math.max(0, Math.floor(high / step) - first + 1);
  return Array.from({ length }, (_, i) => (first + i) * step);
}

const label = (value) => String(Number(value.toPrecision(6))).replace("-", "−");

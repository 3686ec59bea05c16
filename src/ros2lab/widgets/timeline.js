// The time of a recording: a slider, and a button that moves along it.
// All views of one recording in a page show the same moment, which a window's event tells.

const MOMENT = "ros2lab-moment";
const LONGEST_FRAME = 0.1; // s; after a longer one nobody has looked, and the time stood still
const STEPS = 200; // of the slider

// Adds them to `el`, and calls `show` with each moment (s since the recording's begin).
// `state.moment` outlives a view; returns what takes the listeners away.
function timeline(el, { name, span }, state, show) {
  const bar = el.appendChild(document.createElement("div")), step = roundStep(span / STEPS);
  const digits = Math.max(1, -Math.floor(Math.log10(step)));
  const written = (time) => `${time.toFixed(digits)} s`;
  bar.className = "ros2lab-timeline";
  bar.dataset.lmSuppressShortcuts = "true";
  bar.innerHTML = `<button type="button" class="jp-mod-styled"></button>
    <label>time <input type="range" min="0" max="${span}" step="${step}"></label> <output></output>`;
  const [button, slider, output] = ["button", "input", "output"].map((tag) => bar.querySelector(tag));
  slider.setAttribute("aria-label", "Time since the beginning of the recording, in seconds");
  state.moment ??= span;
  let frame = 0, before = 0;

  function update() {
    slider.value = state.moment;
    output.textContent = `${written(state.moment)} of ${written(span)}`;
    slider.setAttribute("aria-valuetext", output.textContent);
    show(state.moment);
  }

  function go(moment) {
    state.moment = Math.max(0, Math.min(span, moment));
    window.dispatchEvent(new CustomEvent(MOMENT, { detail: { name, span, moment: state.moment, by: bar } }));
    update();
  }

  function play(isPlaying) {
    cancelAnimationFrame(frame);
    before = performance.now();
    frame = isPlaying ? requestAnimationFrame(advance) : 0;
    button.textContent = isPlaying ? "Pause" : "Play";
  }

  function advance(now) {
    const passed = Math.max(0, Math.min(LONGEST_FRAME, (now - before) / 1000));
    before = now;
    go(state.moment + passed);
    state.moment < span && bar.isConnected ? (frame = requestAnimationFrame(advance)) : play(false);
  }

  function follow({ detail }) {
    if (detail.by === bar || detail.name !== name || detail.span !== span) return;
    play(false);
    state.moment = detail.moment;
    update();
  }

  button.addEventListener("click", () => {
    if (!frame && state.moment >= span) go(0);
    play(!frame);
  });
  slider.addEventListener("input", () => {
    play(false);
    // The last step may end before the recording does.
    go(slider.valueAsNumber > span - step ? span : slider.valueAsNumber);
  });
  window.addEventListener(MOMENT, follow);
  play(false);
  update();
  return () => {
    play(false);
    window.removeEventListener(MOMENT, follow);
  };
}

// The index of the last row that begins at a time (its first number) or before; 0 if none does.
function rowAt(rows, time) {
  let low = 0, high = rows.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (rows[middle][0] <= time) low = middle;
    else high = middle;
  }
  return low;
}

// Rows of so many float32 each, as Python has sent them in a trait.
function rowsOf(data, columns) {
  const numbers = new Float32Array(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength));
  return Array.from({ length: numbers.length / columns }, (_, i) => numbers.subarray(columns * i, columns * (i + 1)));
}

function roundStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].find((factor) => factor * power >= 0.99 * rough) * power;
}

// The course's progress in JupyterLab's left side bar, with a link to each lesson.
// JupyterLab loads this file as a container of webpack's module federation: an object with `init` and `get`.

(() => {
  const NAME = "ros2lab-progress";
  const ADDRESS = "ros2lab/progress";
  const PERIOD = 2000, LONGEST_PERIOD = 60000; // ms between two looks; the longest while nothing answers
  const RANK = 50; // above the file browser, which has 100
  const SHEET = new URL("progress.css", document.currentScript.src).href;
  const ICON = `<svg xmlns="http://www.w3.org/2000/svg" width="16" viewBox="0 0 24 24">
    <path class="jp-icon3 jp-icon-selectable" fill="#616161"
      d="M3 5.5 4.4 4l1.8 1.8L9.6 2.300 11 3.800 6.200 8.600zM3 12.500 4.400 11l1.800 1.800L9.600 9.300 11 10.800 6.200 15.600zM13 5h8v2h-8zM13 12h8v2h-8zM13 19h8v2h-8zM4 17h5v5H4zm1.500 1.500v2h2v-2z"/></svg>`;
  let scope;

  // A module of JupyterLab's own, and not a second copy of it.
  async function shared(name) {
    const versions = Object.values(scope[name]);
    const version = versions.find(({ loaded }) => loaded) ?? versions[0];
    return (await version.get())();
  }

  async function extension() {
    const [{ ILabShell, ILayoutRestorer }, { URLExt }, { ServerConnection }, { LabIcon }, { Poll }, { Widget }] =
      await Promise.all(
        ["application", "coreutils", "services", "ui-components"].map((name) => shared(`@jupyterlab/${name}`))
          .concat(["polling", "widgets"].map((name) => shared(`@lumino/${name}`))),
      );

    function activate(app, shell, restorer) {
      const settings = app.serviceManager.serverSettings;
      const panel = new Widget();
      panel.id = NAME;
      panel.title.caption = "Course progress";
      panel.title.icon = new LabIcon({ name: `${NAME}:icon`, svgstr: ICON });
      panel.node.setAttribute("role", "navigation");
      panel.node.setAttribute("aria-label", "Course progress");
      panel.addClass("ros2lab-course");
      const open = (path) => app.commands.execute("docmanager:open", { path }).catch(() => {}); // it has told why
      const address = (path) => URLExt.join(settings.baseUrl, "lab/tree", URLExt.encodeParts(path));
      const view = makeView(panel.node, open, address);

      const poll = new Poll({
        name: NAME,
        frequency: { interval: PERIOD, backoff: true, max: LONGEST_PERIOD },
        standby: () => document.hidden || !panel.isVisible,
        factory: async () => {
          const answer = await ServerConnection.makeRequest(URLExt.join(settings.baseUrl, ADDRESS), {}, settings);
          if (!answer.ok) throw new ServerConnection.ResponseError(answer);
          view.show(await answer.text());
        },
      });
      panel.onAfterShow = () => void poll.refresh();
      document.addEventListener("visibilitychange", () => document.hidden || void poll.refresh());
      shell.currentPathChanged.connect((_, { newValue }) => view.mark(newValue));

      shell.add(panel, "left", { rank: RANK, type: "Course" });
      restorer?.add(panel, NAME);
      // At the first start it is open; afterwards it is as the student has left it.
      void Promise.all([shell.restored, app.restored]).then(([layout]) => {
        view.mark(shell.currentPath);
        if (layout.fresh && shell.mode !== "single-document") shell.activateById(panel.id);
      });
    }

    return { id: `${NAME}:plugin`, autoStart: true, requires: [ILabShell], optional: [ILayoutRestorer], activate };
  }

  // Draws what the server has answered into a node.
  function makeView(node, open, address) {
    let shown = null, current = null;
    node.innerHTML = `<link rel="stylesheet" href="${SHEET}"><h2>Course</h2><p role="status">…</p><div></div>`;
    const [status, body] = [node.querySelector("p"), node.querySelector("div")];

    const link = (path, text) => {
      const anchor = element("a", { href: address(path), textContent: text });
      anchor.dataset.path = path;
      return anchor;
    };
    node.addEventListener("click", (event) => {
      const anchor = event.target.closest("a");
      // With one of these the browser opens a tab of its own.
      if (!anchor || event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      open(anchor.dataset.path);
    });

    function show(text) {
      if (text === shown) return;
      shown = text;
      const { lessons, next } = JSON.parse(text);
      const focused = [...node.querySelectorAll("a")].indexOf(document.activeElement);
      status.textContent = sentence(lessons);
      const items = lessons.map((lesson) => {
        const { title, path, done, count } = lesson;
        const amount = element("span", { className: "ros2lab-amount", textContent: `${done}/${count}` });
        amount.setAttribute("aria-label", `${done} of ${count} exercises done`);
        amount.setAttribute("role", "img");
        const mark = element("span", { className: "ros2lab-mark", textContent: isDone(lesson) ? "✔" : done ? "◐" : "○" });
        mark.setAttribute("aria-hidden", "true");
        const bar = element("progress", { max: count, value: done });
        bar.setAttribute("aria-hidden", "true");
        const item = element("li");
        item.append(mark, link(path, title), amount, bar);
        return item;
      });
      const list = element("ul");
      list.append(...items);
      body.replaceChildren(list);
      const following = lessons.find(({ path }) => path === next);
      if (following) {
        const button = link(next, `Next: ${following.title}`);
        button.className = "ros2lab-next";
        body.prepend(button);
      }
      mark(current);
      if (focused >= 0) node.querySelectorAll("a")[focused]?.focus();
    }

    // The lesson that is open beside it.
    function mark(path) {
      current = path;
      for (const anchor of node.querySelectorAll("li a")) {
        if (anchor.dataset.path === path) anchor.setAttribute("aria-current", "page");
        else anchor.removeAttribute("aria-current");
      }
    }

    return { show, mark };
  }

  function sentence(lessons) {
    const total = (key) => lessons.reduce((sum, lesson) => sum + lesson[key], 0);
    const [done, count] = [total("done"), total("count")];
    if (!done) return "Nothing is done yet.";
    return done === count ? "Everything is done." : `${done} of ${count} exercises ${done === 1 ? "is" : "are"} done.`;
  }

  const isDone = ({ done, count }) => done === count;
  const element = (tag, properties = {}) => Object.assign(document.createElement(tag), properties);

  (window._JUPYTERLAB ??= {})[NAME] = {
    init: (sharedScope) => void (scope = sharedScope),
    get: async (name) => {
      if (name !== "./extension") throw new Error(`${NAME} has no module ${name}.`);
      const plugin = await extension();
      return () => ({ __esModule: true, default: plugin });
    },
  };
})();

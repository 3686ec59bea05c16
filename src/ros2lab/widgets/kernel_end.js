// Stands behind the module of a view, and ends it with its kernel. A view whose kernel was killed, restarted or shut
// down becomes what it is in a saved notebook: it stands still, says so, and sends nothing.

function endingWithItsKernel(widget) {
  const LOOK_PERIOD = 1000; // ms
  const MARK = "jupyter-widgets-disconnected"; // Jupyter's own
  const make = () => (typeof widget === "function" ? widget() : widget);

  const hasEnded = ({ widget_manager: manager }) => {
    const kernel = manager?.kernel; // null after a shutdown
    return kernel === null || ["dead", "terminating"].includes(kernel?.status) || kernel?.connectionStatus === "disconnected";
  };

  // Called once a model, as `make` is.
  return () => {
    let current = make(), isLive = true;
    const views = new Set();

    // A model that is silent once its kernel has gone, and can be left.
    function guarded(model) {
      const left = [];
      const send = (...content) => {
        try {
          if (isLive) model.send(...content);
        } catch {
          end(model); // there is nobody to send to
        }
      };
      const on = (...event) => (left.push(event), model.on(...event));
      return [{ ...model, send, on }, () => left.forEach((event) => model.off(...event))];
    }

    function end(model) {
      if (!isLive) return;
      isLive = false;
      // What would be read when the notebook is saved stays as it is now.
      const saved = model.get("saved");
      if (saved) model.set("saved", JSON.parse(JSON.stringify(saved)));
      current = make();
      current.initialize?.({ model });
      views.forEach((draw) => draw());
    }

    return {
      initialize({ model, ...others }) {
        isLive = !model.get("saved");
        model.on("comm_live_update", () => end(model)); // a restart: a model that has lost its kernel gets no other
        return current.initialize?.({ model: guarded(model)[0], ...others });
      },
      render({ model, el, ...others }) {
        let leave = () => {}, stop;
        const clear = () => (leave(), stop?.());

        function draw() {
          clear();
          el.replaceChildren();
          const [own, leaveOwn] = guarded(model);
          leave = leaveOwn;
          stop = current.render({ model: own, el, ...others });
          if (!isLive) el.classList.add(MARK);
          // What lies around a part of a card is not drawn here.
          const card = isLive ? null : el.parentElement?.closest(".ros2lab-card");
          card?.classList.add(MARK);
          for (const control of card?.querySelectorAll("button, input, select") ?? []) control.disabled = true;
        }

        draw();
        views.add(draw);
        const timer = setInterval(() => isLive && hasEnded(model) && end(model), LOOK_PERIOD);
        return () => {
          clearInterval(timer);
          views.delete(draw);
          clear();
        };
      },
    };
  };
}

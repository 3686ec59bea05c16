// A line of text that goes to Python as a whole, on Enter or with the button beside it.

// Called once a model: a view that JupyterLab makes anew has what was typed in the last one.
export default () => {
  let text = "", isSaved = false;

  function initialize({ model }) {
    // From a notebook whose kernel has gone.
    isSaved = Boolean(model.get("saved"));
    if (!isSaved) model.set("saved", true);
  }

  function render({ model, el }) {
    el.classList.add("ros2lab-field");
    el.innerHTML = `
      <label>other <input type="text" class="jp-mod-styled" placeholder="any text, Enter"></label>
      <button type="button" class="jp-mod-styled">send</button>`;
    const [input, button] = ["input", "button"].map((selector) => el.querySelector(selector));
    input.title = button.title = model.get("hint");
    input.value = text;

    function send() {
      if (text) model.send({ text });
      input.value = text = "";
    }

    const show = () => (input.disabled = button.disabled = isSaved || model.get("disabled"));
    input.addEventListener("input", () => (text = input.value));
    input.addEventListener("keydown", (event) => event.key === "Enter" && !event.isComposing && send());
    button.addEventListener("click", send);
    model.on("change:disabled", show);
    show();
  }

  return { initialize, render };
};

// The player in a notebook: its page in a frame of its own, whose clock and the model's are one.
const PAUSE = 100; // milliseconds between two times that the kernel is told while the player runs

function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.setAttribute("sandbox", "allow-scripts");
  frame.title = "truebreak: player";
  frame.style.cssText = `width: 100%; border: 0; height: ${model.get("height")}px`;
  frame.srcdoc = model.get("page");
  let [told, waiting] = [null, null];
  const tell = () => {
    waiting = null;
    model.set("time", told);
    model.save_changes();
  };
  const listen = (event) => {
    if (event.source !== frame.contentWindow || typeof event.data?.truebreakTime !== "number") return;
    told = event.data.truebreakTime;
    waiting ??= setTimeout(tell, PAUSE);
  };
  addEventListener("message", listen);
  model.on("change:time", () => {
    if (model.get("time") !== told) frame.contentWindow.postMessage({ truebreakTime: model.get("time") }, "*");
  });
  model.on("change:height", () => { frame.style.height = `${model.get("height")}px`; });
  el.append(frame);
  return () => {
    clearTimeout(waiting);
    removeEventListener("message", listen);
  };
}

export default { render };

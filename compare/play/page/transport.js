// Who runs the engines: the server that this page came from, or a worker of the browser. Both are asked the same.
const KEPT = "truebreak-token";

// Answers of a server are lines, each an object; `progress` is called for all but the last.
export class Server {
  constructor(token) {
    try {
      if (token) sessionStorage.setItem(KEPT, token);
      this.token = token || sessionStorage.getItem(KEPT) || "";
    } catch {
      this.token = token || "";
    }
  }

  async ready() {
    return this.ask({ kind: "names" });
  }

  async ask(message, progress = () => {}) {
    const answer = await fetch("ask", { method: "POST", headers: { "X-Truebreak-Token": this.token, "Content-Type": "application/json" }, body: JSON.stringify(message) }).catch(() => null);
    if (!answer) return { kind: "refused", error: "truebreak play has ended; start it again" };
    let [rest, last] = ["", null];
    const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    for (;;) {
      const { done, value } = await reader.read().catch(() => ({ done: true }));
      if (done) break;
      const lines = (rest + value).split("\n");
      rest = lines.pop();
      for (const line of lines) {
        const told = JSON.parse(line);
        if (told.kind === "progress") progress(told);
        else last = told;
      }
    }
    return last ?? { kind: "stopped", error: "the run was stopped" };
  }

  async stop() {
    await this.ask({ kind: "stop" });
  }
}

// A worker that holds Python and the engines; a new one after one that was stopped.
export class InBrowser {
  constructor(loading) {
    this.loading = loading;
    this.start();
  }

  start() {
    this.worker = new Worker("worker.js", { type: "module" });
    this.waiting = null;
    this.started = new Promise((done) => {
      this.worker.onmessage = ({ data }) => {
        if (data.kind === "loading") this.loading(data);
        else if (data.kind === "ready" || data.kind === "failed") done(data);
        else if (data.kind === "progress") this.waiting?.progress(data);
        else this.finish(data);
      };
      this.worker.onerror = () => done({ kind: "failed", error: "the engines did not load" });
    });
  }

  finish(data) {
    const waiting = this.waiting;
    this.waiting = null;
    waiting?.done(data);
  }

  async ready() {
    const told = await this.started;
    return told.kind === "failed" ? { kind: "refused", error: told.error } : { kind: "names", engines: told.engines };
  }

  async ask(message, progress = () => {}) {
    const told = await this.ready();
    if (told.kind === "refused") return told;
    if (this.waiting) return { kind: "refused", error: "a run is under way; stop it first, or wait for it" };
    return new Promise((done) => {
      this.waiting = { done, progress };
      this.worker.postMessage(message);
    });
  }

  async stop() {
    this.worker.terminate();
    this.finish({ kind: "stopped", error: "the run was stopped" });
    this.start();
  }
}

// SPDX-License-Identifier: Apache-2.0
// Lets the search run where a page is opened from a disk: browsers start no worker there, so a hidden frame is one.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const script = new URL(url, location.href).href;
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      this.frame.srcdoc =
        `<script>postMessage = (data) => parent.dispatchEvent(new MessageEvent("worker", { data, source: window }))</script>` +
        `<script src="${script}"></script>`;
      this.loaded = new Promise((done) => this.frame.addEventListener("load", done));
      addEventListener("worker", (event) => {
        if (event.source === this.frame.contentWindow) {
          this.dispatchEvent(new MessageEvent("message", { data: event.data }));
        }
      });
      document.body.append(this.frame);
    }

    postMessage(data) {
      this.loaded.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data })));
    }

    terminate() {
      this.frame.remove();
    }
  };
}

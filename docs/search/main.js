// Full-text search without a server: lunr, which mkdocs brings, and the pages' texts as a script.
// Both are loaded when the search is opened first; a page opened from a folder may not fetch.
(function () {
  "use strict";
  const BETWEEN = /[^\p{L}\p{N}]+/u;
  let ready = null;

  function load(name) {
    return new Promise((resolve, reject) => {
      const script = document.createElement("script");
      Object.assign(script, {src: base_url + "/search/" + name, onload: resolve, onerror: reject});
      document.head.append(script);
    });
  }

  async function prepare() {
    await Promise.all([load("lunr.js"), load("index.js")]);
    // Words as typed: the beginning of a word finds it, so none is cut to its stem or left out.
    lunr.tokenizer.separator = BETWEEN;
    return lunr(function () {
      this.pipeline.reset();
      this.searchPipeline.reset();
      this.ref("location");
      this.field("title", {boost: 10});
      this.field("text");
      search_documents.forEach((page) => this.add(page));
    });
  }

  function found(index, words) {
    const hits = index.query((query) => words.forEach((word) => query.term(word, {
      presence: lunr.Query.presence.REQUIRED, wildcard: lunr.Query.wildcard.TRAILING})));
    const pages = new Map(search_documents.map((page) => [page.location, page]));
    return hits.slice(0, 20).map((hit) => pages.get(hit.ref));
  }

  function beside(text, word) {
    const at = Math.max(0, text.toLowerCase().indexOf(word) - 60);
    return (at ? "… " : "") + text.slice(at, at + 200) + " …";
  }

  async function answer() {
    const typed = document.getElementById("mkdocs-search-query").value;
    const words = typed.toLowerCase().split(BETWEEN).filter((word) => word.length > 1);
    const shown = document.getElementById("mkdocs-search-results");
    ready = ready || prepare();
    const pages = words.length ? found(await ready, words) : [];
    shown.replaceChildren(...pages.map((page) => {
      const item = document.createElement("article"), head = document.createElement("h3");
      const link = document.createElement("a"), text = document.createElement("p");
      link.href = base_url + "/" + page.location;
      link.textContent = page.title;
      text.textContent = beside(page.text, words[0]);
      head.append(link);
      item.append(head, text);
      return item;
    }));
    if (words.length && !pages.length) shown.textContent = shown.dataset.noResultsText;
  }

  // The theme puts its dialog behind the scripts.
  addEventListener("DOMContentLoaded", () => {
    const field = document.getElementById("mkdocs-search-query");
    field.addEventListener("input", answer);
    field.form.addEventListener("submit", (event) => event.preventDefault());
  });
})();

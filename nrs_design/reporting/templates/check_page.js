// The verdict of the page must be that of the certificate, and that must be what the id stands for.
async function findAltered(text) {
  const { verdict } = JSON.parse(text);
  if (document.querySelector(".badge").textContent !== verdict) return "the verdict of the page is not that of the certificate";
  // There is no hash where a page is neither a file nor from a secure address.
  if (!crypto.subtle) return null;
  const hash = [...new Uint8Array(await crypto.subtle.digest("SHA-256", new TextEncoder().encode(text)))];
  const id = hash.map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const named = [...document.querySelectorAll("dd")].some((dd) => dd.textContent === id);
  return named ? null : "the numbers are not those of the certificate id of the page";
}

async function judge(text) {
  const altered = await findAltered(text);
  if (altered) return ["bad", `Refused: ${altered}.`];
  const began = performance.now(), { results, agrees, modes, free } = check(text);
  const time = ((performance.now() - began) / 1000).toPrecision(2), wrong = results.filter(([holds]) => holds === false);
  if (wrong.length) return ["bad", `Refused: ${wrong.map(([, words]) => words).join("; ")}.`];
  const open = results.filter(([holds]) => holds === null).map(([, words]) => words);
  if (!agrees && !open.length) return ["bad", "Refused: the verdict does not follow from what is shown."];
  const shown = results.filter(([holds]) => holds).map(([, words]) => words);
  const about = `${modes} modes${free ? ` in contact and ${free} of free motion` : ""}`;
  const held = shown.length ? `Holds for the ${about} in this page, checked in ${time} s: ${shown.join("; ")}.` : "";
  const left = open.length ? `Not checked here: ${open.join("; ")}.` : "";
  const id = crypto.subtle ? "" : "the certificate id, ";
  const rest = `Not checked: ${id}whose modes these are (nrs-design verify does that), the sentences, which no certificate holds, and all other numbers and figures. Who changed a page could change this check, too.`;
  return [open.length ? "unknown" : "good", [held, left, rest].filter(Boolean).join(" ")];
}

function addCheck(text) {
  const bar = document.createElement("div"), told = document.createElement("output");
  const press = button("Check", "Check the proof from the numbers in this page", () => {
    told.textContent = "Checking ...";
    setTimeout(async () => {
      const [state, words] = await judge(text).catch((error) => ["bad", `Refused: ${error.message}.`]);
      Object.assign(told, { className: state, textContent: words });
    });
  });
  bar.className = "tools";
  bar.id = "check";
  bar.append(told, press);
  (document.querySelector(".lights") || document.querySelector(".claim")).after(bar);
}

addCheck(document.getElementById("numbers").textContent);

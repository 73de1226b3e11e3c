// Figures that move and zoom are drawn when they are asked for: the page itself needs no script.
const home = document.getElementById("plotly");
let loading = null;

async function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

function beside(name) {
  return new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = name;
    script.onload = done;
    script.onerror = () => failed(new Error(`${name} has to lie beside this page`));
    document.head.append(script);
  });
}

async function load() {
  if (home.dataset.beside) return beside(home.dataset.beside);
  const script = document.createElement("script");
  script.textContent = await unpacked(home.textContent);
  document.head.append(script);
}

async function open(place) {
  const spec = JSON.parse(document.getElementById(place.dataset.figure).textContent);
  const button = place.querySelector("button");
  const plot = document.createElement("div");
  plot.className = "plot";
  try {
    loading = loading || load();
    await loading;
    place.append(plot);
    await Plotly.newPlot(plot, { ...spec, config: { responsive: true, displaylogo: false } });
    if (button) button.remove();
  } catch (problem) {
    plot.textContent = `This figure cannot be drawn here: ${problem.message}.`;
    place.append(plot);
  }
}

for (const place of document.querySelectorAll("[data-figure]")) {
  const button = place.querySelector("button");
  if (button) button.addEventListener("click", () => open(place), { once: true });
  else open(place);
}

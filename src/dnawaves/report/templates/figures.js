// Figures are drawn when they come near the screen: the page opens at once.
(() => {
  const config = {
    responsive: true,
    displaylogo: false,
    modeBarButtons: [["zoomIn2d", "zoomOut2d", "resetScale2d", "toImage"]],
  };
  const boxes = [...document.querySelectorAll(".plot")];
  const draw = (box) => {
    if (box.dataset.drawn) return;
    box.dataset.drawn = "yes";
    const figure = JSON.parse(document.getElementById(box.dataset.figure).textContent);
    Plotly.newPlot(box, figure.data, figure.layout, config);
  };
  const drawAll = () => boxes.forEach(draw);
  window.addEventListener("beforeprint", drawAll);
  const near = new IntersectionObserver(
    (entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => draw(entry.target)),
    { rootMargin: "800px" },
  );
  boxes.forEach((box) => near.observe(box));
})();

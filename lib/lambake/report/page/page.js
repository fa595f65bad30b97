// The slider: a range input moves the line between two pictures that lie on each other. Without this script
// the line stands still in the middle; printed, the pictures stand side by side.
"use strict";

for (const slider of document.querySelectorAll(".slider")) {
  const stage = slider.querySelector(".stage");
  const range = slider.querySelector("input[type=range]");
  const layer = (name) => stage.querySelector(`img[data-layer="${name}"]`);
  const tag = (side) => slider.querySelector(`.tag-${side}`);

  const show = () => {
    stage.style.setProperty("--split", `${range.value}%`);
    range.setAttribute("aria-valuetext",
      `${Math.round(range.value)} % ${tag("left").textContent}, the rest ${tag("right").textContent}`);
  };
  range.addEventListener("input", show);

  // Pressing or dragging anywhere on the picture moves the line there; a finger still scrolls the page up and
  // down (touch-action in the style sheet).
  const follow = (event) => {
    const box = stage.getBoundingClientRect();
    range.value = 100 * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    show();
  };
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    stage.setPointerCapture(event.pointerId);
    follow(event);
    range.focus({ preventScroll: true });
    event.preventDefault();
  });
  stage.addEventListener("pointermove", (event) => {
    if (stage.hasPointerCapture(event.pointerId)) follow(event);
  });

  // The heat map is in the file once, in its own figure; the slider borrows it.
  const difference = layer("difference");
  const figure = document.getElementById("difference");
  difference.src = figure.src;
  difference.alt = figure.alt;
  difference.hidden = false;

  // Which two of the three pictures are compared.
  for (const choice of slider.querySelectorAll("input[type=radio]")) {
    choice.addEventListener("change", () => {
      for (const side of ["left", "right"]) {
        for (const image of stage.querySelectorAll("img"))
          image.classList.toggle(side, image.dataset.layer === choice.dataset[side]);
        tag(side).textContent = layer(choice.dataset[side]).dataset.name;
      }
      show();
    });
  }
  slider.querySelector(".choices").hidden = false;
  show();
}

// snapshot.js: a PNG of what is shown, in the pixels of the canvas.

// What is drawn over it comes along: a picture of its own, with its style inside.
function pictureOf(svg, width, height) {
  const copy = svg.cloneNode(true), box = svg.getBoundingClientRect();
  for (const [name, value] of [['width', width], ['height', height], ['viewBox', `0 0 ${box.width} ${box.height}`]]) copy.setAttribute(name, value);
  return new Promise((resolve, reject) => {
    const picture = new Image();
    picture.onload = () => resolve(picture);
    picture.onerror = () => reject(new Error('what is drawn over the picture cannot be made one'));
    picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
  });
}

// drawn(): draws the canvas as fine as it can be, at once. curtain: where its line is [pixels], or null.
export async function snapshot(canvas, svg, drawn, curtain) {
  drawn();
  const {width, height} = canvas, copy = Object.assign(document.createElement('canvas'), {width, height}), context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);  // in the same task: WebGL keeps its picture no longer
  if (curtain !== null) {
    context.fillStyle = '#fff';
    context.fillRect(curtain - 1, 0, 2, height);
  }
  context.drawImage(await pictureOf(svg, width, height), 0, 0);
  return new Promise((resolve, reject) => copy.toBlob(blob => blob ? resolve(blob) : reject(new Error('this browser makes no PNG of it')), 'image/png'));
}

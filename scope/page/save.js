// Files that the browser saves: the scene, and pictures.

export function download(name, type, content) {
  const blob = content instanceof Blob ? content : new Blob([content], {type});
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Waveform above spectrum, as they are on the screen. */
export function pngOf(canvases, background) {
  const shown = canvases.filter((canvas) => canvas.clientHeight > 0);
  const whole = document.createElement('canvas');
  whole.width = Math.max(...shown.map((canvas) => canvas.width));
  whole.height = shown.reduce((sum, canvas) => sum + canvas.height, 0);
  const context = whole.getContext('2d');
  context.fillStyle = background;
  context.fillRect(0, 0, whole.width, whole.height);
  let y = 0;
  for (const canvas of shown) {
    context.drawImage(canvas, 0, y);
    y += canvas.height;
  }
  return new Promise((resolve) => { whole.toBlob(resolve, 'image/png'); });
}

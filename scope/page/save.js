// Files that the browser saves: the scene, and pictures.

export function download(name, type, content) {
  const blob = content instanceof Blob ? content : new Blob([content], {type});
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Waveform above spectrum, as they are on the screen, below lines that say what they show. */
export function pngOf(canvases, caption, colour) {
  const shown = canvases.filter((canvas) => canvas.clientHeight > 0);
  const whole = document.createElement('canvas');
  const scale = shown[0].width / shown[0].clientWidth;
  const line = 18 * scale;
  whole.width = Math.max(...shown.map((canvas) => canvas.width));
  whole.height = shown.reduce((sum, canvas) => sum + canvas.height, line * caption.length + 6 * scale);
  const context = whole.getContext('2d');
  context.fillStyle = colour.paper;
  context.fillRect(0, 0, whole.width, whole.height);
  context.fillStyle = colour.ink;
  context.font = `${12 * scale}px system-ui, sans-serif`;
  caption.forEach((text, i) => context.fillText(text, 8 * scale, line * (i + 1) - 4 * scale, whole.width - 16 * scale));
  let y = line * caption.length + 6 * scale;
  for (const canvas of shown) {
    context.drawImage(canvas, whole.width - canvas.width, y);
    y += canvas.height;
  }
  return new Promise((resolve) => { whole.toBlob(resolve, 'image/png'); });
}

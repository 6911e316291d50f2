/** What painters draw with: the part of a canvas that can also be written as SVG. */
export type Pen = Pick<
  CanvasRenderingContext2D,
  | "beginPath"
  | "moveTo"
  | "lineTo"
  | "arc"
  | "stroke"
  | "setLineDash"
  | "lineWidth"
  | "strokeStyle"
  | "fillStyle"
  | "globalAlpha"
  | "lineCap"
  | "lineJoin"
  | "fillRect"
  | "fillText"
  | "font"
  | "textAlign"
>;

/** Draws over a frame in screen pixels, the frame's corner being (0, 0); `scale` is screen pixels per image pixel. */
export type Painter = (pen: Pen, scale: number) => void;

type Style = string | CanvasGradient | CanvasPattern;

/** A pen that writes SVG elements. Arcs are whole circles: nothing else is drawn here. */
export class SvgPen implements Pen {
  lineWidth = 1;
  strokeStyle: Style = "#000";
  fillStyle: Style = "#000";
  globalAlpha = 1;
  lineCap: CanvasLineCap = "butt";
  lineJoin: CanvasLineJoin = "miter";
  font = "12px sans-serif";
  textAlign: CanvasTextAlign = "start";
  readonly elements: string[] = [];
  private path = "";
  private dash = "";

  beginPath(): void {
    this.path = "";
  }

  moveTo(x: number, y: number): void {
    this.path += `M${short(x)} ${short(y)}`;
  }

  lineTo(x: number, y: number): void {
    this.path += `L${short(x)} ${short(y)}`;
  }

  arc(x: number, y: number, r: number): void {
    const [radius, across] = [short(r), short(2 * r)];
    this.path += `M${short(x - r)} ${short(y)}a${radius} ${radius} 0 1 0 ${across} 0a${radius} ${radius} 0 1 0 -${across} 0`;
  }

  setLineDash(segments: Iterable<number>): void {
    this.dash = [...segments].join(" ");
  }

  stroke(): void {
    if (!this.path) return;
    const dash = this.dash && ` stroke-dasharray="${this.dash}"`;
    const ends = ` stroke-linecap="${this.lineCap}" stroke-linejoin="${this.lineJoin}"`;
    this.elements.push(
      `<path d="${this.path}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" opacity="${this.globalAlpha}"${dash}${ends}/>`,
    );
  }

  fillRect(x: number, y: number, width: number, height: number): void {
    this.elements.push(
      `<rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}" fill="${this.fillStyle}" opacity="${this.globalAlpha}"/>`,
    );
  }

  fillText(text: string, x: number, y: number): void {
    const anchor = this.textAlign === "right" ? "end" : this.textAlign === "center" ? "middle" : "start";
    this.elements.push(
      `<text x="${short(x)}" y="${short(y)}" style="font: ${this.font.replace(/"/g, "'")}" fill="${this.fillStyle}" text-anchor="${anchor}">${escaped(text)}</text>`,
    );
  }
}

function short(value: number): number {
  return Math.round(value * 100) / 100;
}

function escaped(text: string): string {
  return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

/** Plotly with the traces that our figures use, and no more. */
import bar from "plotly.js/lib/bar";
import contour from "plotly.js/lib/contour";
import Plotly from "plotly.js/lib/core";
import heatmap from "plotly.js/lib/heatmap";
import histogram from "plotly.js/lib/histogram";
import quiver from "plotly.js/lib/quiver";

// biome-ignore lint/suspicious/noExplicitAny: the type of a trace module is Plotly's own affair
Plotly.register([bar, contour, heatmap, histogram, quiver] as any);

export default Plotly;

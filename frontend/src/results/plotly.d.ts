// Single modules of plotly.js carry no types of their own.
declare module "plotly.js/lib/core" {
  import type * as Plotly from "plotly.js";

  const core: typeof Plotly;
  export default core;
}

declare module "plotly.js/lib/*" {
  const trace: object;
  export default trace;
}

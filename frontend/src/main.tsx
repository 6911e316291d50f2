import { MantineProvider } from "@mantine/core";
import { QueryClientProvider } from "@tanstack/react-query";
import { RouterProvider } from "@tanstack/react-router";
import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import "@fontsource-variable/inter/index.css";
import "@mantine/core/styles.css";
import "./main.css";
import { connectClient } from "./platform/api";
import { forgetBaseElement } from "./platform/base";
import { queryClient } from "./platform/queryClient";
import { router } from "./routes";
import { readableVariables, theme } from "./theme";
import { guardUploads } from "./uploads/uploads";

connectClient();
forgetBaseElement();
guardUploads();

createRoot(document.getElementById("root") as HTMLElement).render(
  <StrictMode>
    <MantineProvider theme={theme} cssVariablesResolver={readableVariables} defaultColorScheme="auto">
      <QueryClientProvider client={queryClient}>
        <RouterProvider router={router} />
      </QueryClientProvider>
    </MantineProvider>
  </StrictMode>,
);

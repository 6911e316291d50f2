import { Button, Container } from "@mantine/core";
import type { ErrorComponentProps } from "@tanstack/react-router";
import { ProblemAlert } from "./ProblemAlert";
import { toProblem } from "./problem";

/** A page that broke says so, and can be loaded again. */
export function PageError({ error }: ErrorComponentProps) {
  return (
    <Container size="sm" py="xl">
      <ProblemAlert problem={toProblem(error)}>
        <div>
          <Button size="xs" variant="default" onClick={() => window.location.reload()}>
            Reload
          </Button>
        </div>
      </ProblemAlert>
    </Container>
  );
}

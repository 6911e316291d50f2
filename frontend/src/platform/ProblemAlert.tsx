import { Alert, Code, List, Stack, Text } from "@mantine/core";
import { IconAlertTriangle } from "@tabler/icons-react";
import type { ReactNode } from "react";
import type { Problem } from "../client";
import { plainField } from "./fields";

type ProblemAlertProps = {
  problem: Problem;
  title?: string;
  /** Fields whose messages stand beside their inputs and need no second place. */
  shownFields?: (field: string) => boolean;
  children?: ReactNode;
};

/** What happened, where, and what to do: the one way a problem is shown. */
export function ProblemAlert({ problem, title, shownFields = () => false, children }: ProblemAlertProps) {
  const messages = (problem.errors ?? []).filter(({ field }) => !shownFields(field));
  return (
    <Alert
      color="red"
      variant="light"
      icon={<IconAlertTriangle aria-hidden />}
      title={title ?? problem.title}
      role="alert"
    >
      <Stack gap={6}>
        <Text fz="sm">{problem.detail}</Text>
        <Where problem={problem} />
        {messages.length > 0 && (
          <List size="sm" spacing={2}>
            {messages.map(({ field, message }) => (
              <List.Item key={`${field} ${message}`}>
                {field && <b>{plainField(field)}: </b>}
                {message}
              </List.Item>
            ))}
          </List>
        )}
        {problem.hint && <Text fz="sm">{problem.hint}</Text>}
        {children}
        <Text fz="xs" c="dimmed">
          Code {problem.code}
        </Text>
      </Stack>
    </Alert>
  );
}

function Where({ problem }: { problem: Problem }) {
  if (problem.file == null && problem.frame == null) return null;
  return (
    <Text fz="sm">
      {problem.file != null && (
        <>
          File <Code>{problem.file}</Code>
        </>
      )}
      {problem.file != null && problem.frame != null && ", "}
      {problem.frame != null && `frame ${problem.frame}`}
    </Text>
  );
}

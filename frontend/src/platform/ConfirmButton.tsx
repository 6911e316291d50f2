import { Button, type ButtonProps, Group, Modal, Stack, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import type { UseMutationResult } from "@tanstack/react-query";
import type { ReactNode } from "react";
import { ProblemAlert } from "./ProblemAlert";
import { toProblem } from "./problem";

type ConfirmButtonProps = {
  label: string;
  size?: ButtonProps["size"];
  title: string;
  /** What the button in the dialogue does, in its words. */
  action: string;
  mutation: Pick<UseMutationResult<unknown, Error, void>, "mutate" | "isPending" | "error" | "reset">;
  children: ReactNode;
};

/** A button for what cannot be undone: it asks first. */
export function ConfirmButton({ label, size, title, action, mutation, children }: ConfirmButtonProps) {
  const [isOpen, { open, close }] = useDisclosure(false, { onOpen: mutation.reset });
  return (
    <>
      <Button variant="default" size={size} onClick={open}>
        {label}
      </Button>
      <Modal opened={isOpen} onClose={close} title={title} centered>
        <Stack>
          <Text fz="sm">{children}</Text>
          {mutation.error && <ProblemAlert problem={toProblem(mutation.error)} />}
          <Group justify="flex-end" gap="xs">
            <Button variant="default" onClick={close} data-autofocus>
              Keep it
            </Button>
            <Button
              color="red"
              loading={mutation.isPending}
              onClick={() => mutation.mutate(undefined, { onSuccess: close })}
            >
              {action}
            </Button>
          </Group>
        </Stack>
      </Modal>
    </>
  );
}

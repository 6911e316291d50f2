import { Button, Center, Paper, PasswordInput, Stack, Text, TextInput, Title } from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import { useMutation, useQuery } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { invitationsAccept, invitationsLook, type NewAccount, type Session, type Welcome } from "../client";
import { ProblemAlert } from "../platform/ProblemAlert";
import { fieldMessages, toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import { sessionQuery, useEnter } from "./session";

const MAY: Record<Welcome["right"], string> = {
  view: "look at what belongs to it",
  edit: "look at what belongs to it, add experiments and analyse them",
  manage: "do everything in it, and invite others",
};

/** /invitation#SECRET: join a group, with the account one has or with a new one. */
export function InvitationPage() {
  useDocumentTitle("Invitation · Dropflow");
  const [secret] = useState(() => window.location.hash.slice(1));
  const session = useQuery(sessionQuery);
  const welcome = useQuery({
    queryKey: ["invitation", secret],
    queryFn: async () => (await invitationsLook({ body: { secret } })).data,
    retry: false,
  });
  if (welcome.error) return <ProblemAlert problem={toProblem(welcome.error)} />;
  if (welcome.data === undefined || session.data === undefined) return <Loading />;
  const { group_name, right, invited_by } = welcome.data;
  return (
    <Center mih="60vh">
      <Paper withBorder p="xl" w={440} maw="100%">
        <Stack>
          <Title order={1}>Join {group_name}</Title>
          <Text fz="sm">
            {invited_by ?? "Somebody"} invites you to this group. There you may {MAY[right]}.
          </Text>
          {session.data.person === null ? (
            <NewAccountForm secret={secret} />
          ) : (
            <JoinAs secret={secret} session={session.data} />
          )}
        </Stack>
      </Paper>
    </Center>
  );
}

function useAccept(secret: string) {
  const navigate = useNavigate();
  const enter = useEnter();
  return useMutation({
    mutationFn: async (account: NewAccount | null) =>
      (await invitationsAccept({ body: { secret, account } })).data,
    onSuccess: async (session) => {
      enter(session);
      await navigate({ to: "/" });
    },
  });
}

function JoinAs({ secret, session }: { secret: string; session: Session }) {
  const accept = useAccept(secret);
  return (
    <>
      {accept.error && <ProblemAlert problem={toProblem(accept.error)} />}
      <Button onClick={() => accept.mutate(null)} loading={accept.isPending}>
        Join as {session.person?.name}
      </Button>
    </>
  );
}

function NewAccountForm({ secret }: { secret: string }) {
  const accept = useAccept(secret);
  const [account, setAccount] = useState<NewAccount>({ name: "", email: "", password: "" });
  const problem = accept.error && toProblem(accept.error);
  const messages = fieldMessages(problem);
  const input = (field: keyof NewAccount) => ({
    required: true,
    withAsterisk: false,
    value: account[field],
    error: messages[`account.${field}`],
    onChange: (event: React.ChangeEvent<HTMLInputElement>) => {
      const { value } = event.currentTarget;
      setAccount((before) => ({ ...before, [field]: value }));
    },
  });
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        accept.mutate(account);
      }}
    >
      <Stack>
        <TextInput label="Name" autoComplete="name" {...input("name")} />
        <TextInput label="E-mail" type="email" autoComplete="username" {...input("email")} />
        <PasswordInput
          label="Password"
          description="10 characters or more"
          autoComplete="new-password"
          minLength={10}
          {...input("password")}
        />
        {problem && <ProblemAlert problem={problem} shownFields={(field) => field.startsWith("account.")} />}
        <Button type="submit" loading={accept.isPending}>
          Make an account and join
        </Button>
        <Text fz="sm" c="dimmed">
          You have an account? <a href=".">Sign in</a> first, then open the link again.
        </Text>
      </Stack>
    </form>
  );
}

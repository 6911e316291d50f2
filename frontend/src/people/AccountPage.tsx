import { Button, Group, PasswordInput, Stack, Switch, Text, TextInput } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { accountPassword, accountUpdate, type Session } from "../client";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { fieldMessages, toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { Browsers } from "./Browsers";
import { sessionQuery } from "./session";
import { Tokens } from "./Tokens";

/** One's own account: name, password, tokens, and where one is signed in. */
export function AccountPage() {
  const session = useQuery(sessionQuery);
  return (
    <Page title="Account">
      <QueryView query={session}>
        {(found) => (
          <>
            <Profile session={found} />
            <Tokens />
            {!found.is_local && <PasswordForm hasPassword={found.person?.has_password ?? false} />}
            <Browsers />
          </>
        )}
      </QueryView>
    </Page>
  );
}

function Profile({ session }: { session: Session }) {
  const cache = useQueryClient();
  const [name, setName] = useState(session.person?.name ?? "");
  const change = useMutation({
    mutationFn: () => accountUpdate({ body: { name } }),
    onSuccess: () => cache.invalidateQueries({ queryKey: sessionQuery.queryKey }),
  });
  const mail = useMutation({
    mutationFn: (is_mailed: boolean) => accountUpdate({ body: { is_mailed } }),
    onSuccess: () => cache.invalidateQueries({ queryKey: sessionQuery.queryKey }),
  });
  const problem = change.error && toProblem(change.error);
  return (
    <Panel
      title="You"
      about={session.person?.email ?? "This is your own machine: there are no other people."}
    >
      <form
        onSubmit={(event) => {
          event.preventDefault();
          change.mutate();
        }}
      >
        <Group align="flex-end">
          <TextInput
            label="Name"
            value={name}
            error={fieldMessages(problem).name}
            onChange={(event) => setName(event.currentTarget.value)}
            w={320}
          />
          <Button
            type="submit"
            variant="default"
            loading={change.isPending}
            disabled={name === session.person?.name}
          >
            Save
          </Button>
        </Group>
      </form>
      {problem && <ProblemAlert problem={problem} shownFields={(field) => field === "name"} />}
      {session.is_mailing && session.person?.email && (
        <Switch
          label="E-mail me when a run that I started has completed or failed"
          checked={session.person.is_mailed}
          disabled={mail.isPending}
          onChange={(event) => mail.mutate(event.currentTarget.checked)}
        />
      )}
      {mail.error && <ProblemAlert problem={toProblem(mail.error)} />}
    </Panel>
  );
}

function PasswordForm({ hasPassword }: { hasPassword: boolean }) {
  const cache = useQueryClient();
  const [old, setOld] = useState("");
  const [next, setNext] = useState("");
  const change = useMutation({
    mutationFn: () => accountPassword({ body: { old: old || null, new: next } }),
    onSuccess: async () => {
      setOld("");
      setNext("");
      await cache.invalidateQueries({ queryKey: sessionQuery.queryKey });
    },
  });
  const problem = change.error && toProblem(change.error);
  const messages = fieldMessages(problem);
  return (
    <Panel
      title="Password"
      about={
        hasPassword
          ? "After a change every other browser is signed out."
          : "Choose one to sign in with your e-mail address."
      }
    >
      <form
        onSubmit={(event) => {
          event.preventDefault();
          change.mutate();
        }}
      >
        <Stack maw={320}>
          {hasPassword && (
            <PasswordInput
              label="The password you have"
              description="Not needed after you signed in with a link"
              autoComplete="current-password"
              value={old}
              error={messages.old}
              onChange={(event) => setOld(event.currentTarget.value)}
            />
          )}
          <PasswordInput
            label="New password"
            description="10 characters or more"
            autoComplete="new-password"
            minLength={10}
            required
            withAsterisk={false}
            value={next}
            error={messages.new}
            onChange={(event) => setNext(event.currentTarget.value)}
          />
          {problem && <ProblemAlert problem={problem} shownFields={(field) => field in messages} />}
          {change.isSuccess && (
            <Text fz="sm" role="status">
              Your password was changed.
            </Text>
          )}
          <div>
            <Button type="submit" variant="default" loading={change.isPending}>
              Change the password
            </Button>
          </div>
        </Stack>
      </form>
    </Panel>
  );
}

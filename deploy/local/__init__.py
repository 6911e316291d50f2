"""Dropflow on one machine without Docker: its servers, its processes and the demo, started by one command.

- `options`: what the environment says: PORT, DATA, DATABASE_URL, REDIS_URL, DEMO
- `folder`: what DATA holds, its passwords, and the lock that keeps a second instance out
- `accounts`: as whom a server runs when we are root
- `processes`: one child process: how it starts, dies and is found again after a crash
- `postgres`, `valkey`: each server on a folder; the tests start theirs with these, too
- `services`: the commands of the API and the workers
- `supervisor`: starts again what dies, ends all in order
- `instance`: all of it in its order, from the first start to the last stop
- `demo`: a small simulated experiment, sent through the public API
"""

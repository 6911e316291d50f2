"""The workers: they claim shards of work by leases in Postgres, do them, and publish what they made."""

"""What whoever runs the service needs: its health for machines, its measures, a doctor, backup and restore."""

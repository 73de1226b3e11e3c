"""Link inertias that no drawing gives, from published or measured figures."""

"""Any set of flights: verdict, charts, tables, single flights."""

d = load("soft-tissue.mat");
at = @(p, s) p.C*((s*eye(rows(p.A)) - p.A)\p.B) + p.D;
M = d.plant(2);
for i = 1:numel(d.loops)
  L = d.loops(i);
  parts = strsplit(L.name, "/");
  K = d.controllers(strcmp({d.controllers.name}, parts{1}));
  E = d.contacts(strcmp({d.contacts.name}, parts{2}));
  worst = 0;
  for s = j*logspace(-1, 3, 9)
    k = at(K, s);
    if numel(d.force_filter), k = k*at(d.force_filter(1), s); end
    y = at(M, s)*k/(1 - at(M, s)*k*at(E, s));
    wanted = [y; at(E, s)*y];
    worst = max(worst, norm(at(L, s) - wanted)/norm(wanted));
  end
  printf("%s %s %s %d %d\n", L.name, L.outputs{1}, L.output_units{2}, worst < 1e-9, ...
         max(real(eig(L.A))) < 0)
end
